"""Opens a run in ParaView with the colours of its scene, or colours of its own: water by speed, sheets by body, tanks
as glass.

    pvpython scripts/paraview_run.py DIR [-o picture.png] [--size 1280x800]

Writes DIR/run.pvsm, a state that `paraview DIR/run.pvsm` opens with all frames; -o writes a
picture of the last frame."""
import argparse
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "blender/projdyn"))
from run_directory import RunError, is_z_up, read_run  # noqa: E402

PALETTE = ((0.84, 0.37, 0.18), (0.22, 0.45, 0.70), (0.85, 0.65, 0.25), (0.30, 0.58, 0.40))


def arguments():
    parser = argparse.ArgumentParser(prog="pvpython scripts/paraview_run.py")
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("-o", "--output", help="a picture of the last frame, PNG")
    parser.add_argument("--size", default="1280x800")
    return parser.parse_args()


def colour_by_speed(display, view, simple):
    """One scale of colours for all frames, from rest to the highest speed."""
    simple.ColorBy(display, ("POINTS", "velocity", "Magnitude"))
    simple.GetColorTransferFunction("velocity").ApplyPreset("Viridis (matplotlib)", True)
    display.RescaleTransferFunctionToDataRangeOverTime()
    display.SetScalarBarVisibility(view, True)
    bar = simple.GetScalarBar(simple.GetColorTransferFunction("velocity"), view)
    bar.Title, bar.ComponentTitle, bar.RangeLabelFormat = "speed, m/s", "", "%-.2g"
    bar.TitleColor = bar.LabelColor = (0.15, 0.15, 0.15)
    bar.ScalarBarLength, bar.TitleFontSize, bar.LabelFontSize = 0.25, 14, 12
    bar.WindowLocation = "Lower Right Corner"


def show(part, number, view, simple):
    """Adds a part of the run to the view."""
    reader = simple.OpenDataFile(str(part.file), registrationName=part.name)
    display = simple.Show(reader, view)
    if part.radius:
        display.SetRepresentationType("Point Gaussian")
        display.GaussianRadius, display.ShaderPreset = part.radius, "Sphere"
    if part.role in ("water", "particles", "grains") and not part.color:
        colour_by_speed(display, view, simple)
        return
    display.ColorArrayName = ("POINTS", "")
    solid = part.role in ("tank", "obstacle")
    display.DiffuseColor = part.color or ((0.75, 0.77, 0.80) if solid else PALETTE[number % len(PALETTE)])
    display.Opacity = 0.15 if part.role == "tank" else 1.0


def main():
    options = arguments()
    try:
        parts, z_up = read_run(options.directory.resolve()), is_z_up(options.directory)
    except RunError as error:
        sys.exit(str(error))
    from paraview import simple
    simple._DisableFirstRenderCameraReset()
    view = simple.CreateRenderView()
    view.UseColorPaletteForBackground, view.Background = 0, (0.93, 0.94, 0.95)
    for number, part in enumerate(parts):
        show(part, number, view, simple)
    simple.GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
    simple.GetAnimationScene().GoToLast()
    view.CameraFocalPoint = (0, 0, 0)
    view.CameraPosition, view.CameraViewUp = ((0.5, -1, 0.5), (0, 0, 1)) if z_up else ((0.5, 0.5, 1), (0, 1, 0))
    simple.ResetCamera(view)
    state = options.directory / "run.pvsm"
    simple.SaveState(str(state))
    if options.output:
        size = tuple(map(int, options.size.split("x")))
        simple.SaveScreenshot(options.output, view, ImageResolution=size)
    print(f"written: {state}; next: paraview {state}")


main()

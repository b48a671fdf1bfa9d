/* Pictures and films of the view. */

function download(blob, ending) {
  const url = URL.createObjectURL(blob), name = (meta.about.name || "replay").replace(/[^A-Za-z0-9]+/g, "_");
  Object.assign(document.createElement("a"), { href: url, download: `${name}.${ending}` }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/* What the renderer has just drawn, with the legends, as a picture of some pixels. */
function composePicture(width, height) {
  const out = Object.assign(document.createElement("canvas"), { width, height }), context = out.getContext("2d");
  context.imageSmoothingQuality = "high";
  context.drawImage(renderer.gl.canvas, 0, 0, width, height);
  drawLegends(context);
  return out;
}

function savePicture() {
  const { canvas } = renderer.gl;
  fitCanvas(canvas, 1);
  renderer.draw(player.frame);
  composePicture(canvas.width, canvas.height).toBlob((blob) => download(blob, `${String(player.frame).padStart(6, "0")}.png`));
}

/* Records as WebM what the player shows for a film. */
function recordFilm(button) {
  if (!window.MediaRecorder) {
    button.textContent = "No WebM in this browser";
    return;
  }
  const recorder = new MediaRecorder(renderer.gl.canvas.captureStream(), { videoBitsPerSecond: 12e6 }), pieces = [];
  recorder.ondataavailable = (e) => pieces.push(e.data);
  recorder.onstop = () => {
    player.recording = false;
    download(new Blob(pieces, { type: recorder.mimeType }), "webm");
  };
  player.recording = true;
  player.film(button, () => recorder.stop());
  recorder.start();
}

/* A frame as a PNG in base64, for `projdyn render`. samples: pixels drawn for one of the picture, along a side; turn: degrees
 * by which the camera stands further around its target */
function pictureOfFrame(frame, width, height, samples, turn = 0) {
  const { camera, gl: { canvas } } = renderer, { yaw, pitch, scale, target } = camera;
  player.play(false);
  player.show(frame);
  canvas.width = samples * width;
  canvas.height = samples * height;
  moveCamera(camera, player.time);
  camera.yaw += turn * Math.PI / 180;
  renderer.draw(player.frame);
  Object.assign(camera, { yaw, pitch, scale, target });
  return composePicture(width, height).toDataURL("image/png").split(",")[1];
}

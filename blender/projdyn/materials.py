"""Materials of the parts of a run, made once per role and colour and reused."""
import math

import bpy

MATTE = {"particles": (0.05, 0.25, 0.55), "grains": (0.62, 0.45, 0.25),
         "obstacle": (0.40, 0.40, 0.42), "ground": (0.55, 0.56, 0.58)}
WATER = (0.037, 0.37, 0.63)  # over the size of its body
PALETTE = ((0.80, 0.24, 0.10), (0.10, 0.32, 0.62), (0.85, 0.60, 0.12), (0.20, 0.48, 0.28))


def linear(color):
    """Linear light of an sRGB colour (IEC 61966-2-1)."""
    return tuple(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in color)


def principled(material):
    return material.node_tree.nodes["Principled BSDF"]


def set_input(node, values):
    """Sets the inputs of a node that it has: Blender 4 renamed some of them."""
    for name, value in values.items():
        if name in node.inputs:
            node.inputs[name].default_value = value


def pass_shadow_rays(material, surface):
    """Lets light through to what is behind: the renderer finds no way through refracting or
    reflecting surfaces to a small light. surface: the output socket of the shader."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    path, mix = nodes.new("ShaderNodeLightPath"), nodes.new("ShaderNodeMixShader")
    links.new(path.outputs["Is Shadow Ray"], mix.inputs[0])
    links.new(surface, mix.inputs[1])
    links.new(nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], nodes["Material Output"].inputs["Surface"])


def absorption(color):
    """Colour and density of Blender's absorption, density (1 - colour), that leaves `color` of white light over 1 m."""
    depth = [-math.log(max(c, 0.01)) for c in color]
    density = max(*depth, 0.01)
    return tuple(1 - d / density for d in depth), density


def make_water(material, size, color):
    """Clear, refractive water. size: m, of its body. color: linear, what is left of white light over that length;
    None: that of water."""
    shader = principled(material)
    set_input(shader, {"Base Color": (1, 1, 1, 1), "Roughness": 0.0, "IOR": 1.333,
                       "Transmission": 1.0, "Transmission Weight": 1.0})
    pass_shadow_rays(material, shader.outputs[0])
    nodes = material.node_tree.nodes
    volume = nodes.new("ShaderNodeVolumeAbsorption")
    absorbed, density = absorption(color or WATER)
    set_input(volume, {"Color": (*absorbed, 1), "Density": density / size})
    material.node_tree.links.new(volume.outputs[0], nodes["Material Output"].inputs["Volume"])
    material.diffuse_color = (*(color or (0.15, 0.45, 0.75)), 1)


def make_matte(material, colour, sheen=0.0):
    set_input(principled(material), {
        "Base Color": (*colour, 1), "Roughness": 0.75, "Sheen": sheen, "Sheen Weight": sheen})
    material.diffuse_color = (*colour, 1)


def make_glass(material):
    """A pane without thickness: it reflects by its angle and does not refract."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.remove(principled(material))
    weight, mix = nodes.new("ShaderNodeLayerWeight"), nodes.new("ShaderNodeMixShader")
    clear, mirror = nodes.new("ShaderNodeBsdfTransparent"), nodes.new("ShaderNodeBsdfGlossy")
    set_input(weight, {"Blend": 0.2})
    set_input(clear, {"Color": (0.94, 0.97, 0.96, 1)})
    set_input(mirror, {"Roughness": 0.0})
    links.new(weight.outputs["Fresnel"], mix.inputs[0])
    links.new(clear.outputs[0], mix.inputs[1])
    links.new(mirror.outputs[0], mix.inputs[2])
    pass_shadow_rays(material, mix.outputs[0])
    material.diffuse_color = (0.8, 0.9, 0.95, 0.15)
    material.blend_method = "BLEND"  # of Eevee


def material_of(role, number=0, size=1.0, color=None):
    """The material of a role in an sRGB colour. Without one, cloth and soft bodies take the colour `number` of the
    palette. Water absorbs by its size (m). A tank stays glass."""
    colour, name = number % len(PALETTE), f"projdyn {role}"
    if color and role != "tank":
        color, name = linear(color), f"{name} #" + "".join(f"{round(255 * c):02x}" for c in color)
    elif role in ("cloth", "soft"):
        name = f"{name} {colour}"
    material = bpy.data.materials.get(name)
    if material:
        return material
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    if role == "water":
        make_water(material, size, color)
    elif role == "tank":
        make_glass(material)
    elif role in ("cloth", "soft"):
        make_matte(material, color or PALETTE[colour], sheen=0.5 if role == "cloth" else 0.0)
    else:
        make_matte(material, color or MATTE[role])
    return material

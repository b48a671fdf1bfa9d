"""Materials of the parts of a run, made once per role and reused."""
import bpy

MATTE = {"particles": (0.05, 0.25, 0.55), "grains": (0.62, 0.45, 0.25),
         "obstacle": (0.40, 0.40, 0.42), "ground": (0.55, 0.56, 0.58)}
PALETTE = ((0.80, 0.24, 0.10), (0.10, 0.32, 0.62), (0.85, 0.60, 0.12), (0.20, 0.48, 0.28))


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


def make_water(material, size):
    """Clear, refractive water. size: m, of its body; over it 1/e of the green light is absorbed."""
    shader = principled(material)
    set_input(shader, {"Base Color": (1, 1, 1, 1), "Roughness": 0.0, "IOR": 1.333,
                       "Transmission": 1.0, "Transmission Weight": 1.0})
    pass_shadow_rays(material, shader.outputs[0])
    nodes = material.node_tree.nodes
    volume = nodes.new("ShaderNodeVolumeAbsorption")
    set_input(volume, {"Color": (0.0, 0.70, 0.86, 1), "Density": 3.3 / size})
    material.node_tree.links.new(volume.outputs[0], nodes["Material Output"].inputs["Volume"])
    material.diffuse_color = (0.15, 0.45, 0.75, 1)


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


def material_of(role, number=0, size=1.0):
    """The material of a role; cloth and soft bodies take the colour `number` of the palette, water
    absorbs by its size (m)."""
    colour = number % len(PALETTE)
    name = f"projdyn {role} {colour}" if role in ("cloth", "soft") else f"projdyn {role}"
    material = bpy.data.materials.get(name)
    if material:
        return material
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    if role == "water":
        make_water(material, size)
    elif role == "tank":
        make_glass(material)
    elif role in ("cloth", "soft"):
        make_matte(material, PALETTE[colour], sheen=0.5 if role == "cloth" else 0.0)
    else:
        make_matte(material, MATTE[role])
    return material

4"""A rig of projector and camera as a scene of Blender.

Run it with
    blender --python FILE
    blender --python FILE -- --picture stripes.png --cloud cloud.ply
or in the text editor. Metres, z up; the camera stands at the origin and looks along +y. The scene
"seen by the projector" has the projector's resolution. Render with Cycles to see its light.
"""

import argparse
import json
import os
import sys

import bpy
from mathutils import Matrix

CAMERA = {
    "name": "camera",
    "width": 1280,
    "height": 960,
    "sensor_width": 36.306358337402344,
    "lens": 43.568782806396484,
    "shift_x": 1.4123131671928135e-6,
    "shift_y": -1.3146284549403476e-6,
    "pixel_aspect_x": 1.0,
    "pixel_aspect_y": 1.0,
    "matrix_world": [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
    "focal_uv": (1.2000317520005903, 1.6000423360007872),
    "principal_uv": (0.4999985876868328, 0.5000017528379399),
    "spot_size": 0.9795375117496126,
}
PROJECTOR = {
    "name": "projector",
    "width": 1024,
    "height": 768,
    "sensor_width": 36.088558197021484,
    "lens": 55.93571090698242,
    "shift_x": -1.2347599291251399e-5,
    "shift_y": 0.3748603850127741,
    "pixel_aspect_x": 1.0,
    "pixel_aspect_y": 1.0,
    "matrix_world": [[0.9866637936557143, 0.009568247592228272, 0.16249002100722332, 0.1800244288416816], [0.1627714904314762, -0.05808426575250126, -0.9849526181368873, 0.030107615940567697], [1.3843045365867675e-5, 0.9982658296816569, -0.05886707992047396, -0.299999137547647], [0.0, 0.0, 0.0, 1.0]],
    "focal_uv": (1.5499569310024048, 2.06660924133654),
    "principal_uv": (0.5000123475992913, 0.00018615331630122967),
    "spot_size": 1.0744580842738474,
}
WORLD_FROM_CAMERA_MM = [[0.001, 0.0, 0.0, 0.0], [0.0, 0.0, 0.001, 0.0], [0.0, -0.001, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
# The corners TL, TR, BR, BL of each sheet.
SHEETS = [
]
# The whole rig, which slcal imports again; changes above do not come back.
RIG = r'''
{
  "schema": "slcal-rig/1",
  "units": "mm",
  "pixel_centre": "integer",
  "camera": {
    "width": 1280,
    "height": 960,
    "K": [
      [
        1536.0406425607557,
        0.0,
        639.498192239146
      ],
      [
        0.0,
        1536.0406425607557,
        479.4983172755777
      ],
      [
        0.0,
        0.0,
        1.0
      ]
    ],
    "distortion": [
      0.0,
      0.0,
      0.0,
      0.0,
      0.0
    ],
    "sigma": null
  },
  "projector": {
    "width": 1024,
    "height": 768,
    "K": [
      [
        1587.1558973464626,
        0.0,
        511.51264394167424
      ],
      [
        0.0,
        1587.1558973464626,
        767.3570342530807
      ],
      [
        0.0,
        0.0,
        1.0
      ]
    ],
    "distortion": [
      0.0,
      0.0,
      0.0,
      0.0,
      0.0
    ],
    "sigma": null
  },
  "projector_from_camera": {
    "R": [
      [
        0.9866637936557143,
        -0.000013843045365867675,
        0.1627714904314762
      ],
      [
        -0.009568247592228272,
        0.9982658296816569,
        0.05808426575250126
      ],
      [
        -0.16249002100722332,
        -0.05886707992047396,
        0.9849526181368873
      ]
    ],
    "t": [
      -182.52009452995065,
      -299.5051484054428,
      17.25767128386678
    ],
    "sigma_t_mm": null,
    "sigma_r_rad": null
  },
  "views": [],
  "method": "unknown",
  "quality": null,
  "covariance": null
}
'''


def arguments():
    """What stands behind `--` on the command line."""
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="blender --python FILE --")
    parser.add_argument("--picture", help="what the projector shows; a test card unless given")
    parser.add_argument("--cloud", help="a PLY of slcal, in the camera's frame")
    parser.add_argument("--watts", type=float, default=100.0, help="how strong the projector's light is")
    return parser.parse_known_args(given)[0]


def clear_startup(scene):
    """Takes away what Blender starts with; a scene of one's own stays as it is."""
    if {o.name for o in scene.objects} == {"Cube", "Light", "Camera"}:
        for thing in list(scene.objects):
            bpy.data.objects.remove(thing, do_unlink=True)


def hang(thing, matrix):
    """Places a thing in the rig. This matrix keeps all its digits; one that is turned into angles or quaternions does not."""
    thing.parent = bpy.data.objects[RIG_OBJECT]
    thing.matrix_parent_inverse = Matrix(matrix)


def placed(collection, name, data, matrix):
    thing = bpy.data.objects.new(name, data)
    collection.objects.link(thing)
    hang(thing, matrix)
    return thing


def add_camera(scene, collection, device):
    """A camera with the device's lens and place; its resolution and the shape of its pixels belong to the scene."""
    data = bpy.data.cameras.new(device["name"])
    data.sensor_fit = "HORIZONTAL"
    data.sensor_width = device["sensor_width"]
    data.lens = device["lens"]
    data.shift_x = device["shift_x"]
    data.shift_y = device["shift_y"]
    data.clip_start, data.clip_end = 0.001, 1000.0
    render = scene.render
    render.resolution_x, render.resolution_y = device["width"], device["height"]
    render.resolution_percentage = 100
    render.pixel_aspect_x, render.pixel_aspect_y = device["pixel_aspect_x"], device["pixel_aspect_y"]
    # Only this engine lets a light show a picture.
    render.engine = "CYCLES"
    scene.camera = placed(collection, device["name"], data, device["matrix_world"])
    return scene.camera


def add_light(collection, device, picture, watts):
    """A spot whose direction picks the pixel of the picture, as the projector's pinhole does."""
    light = bpy.data.lights.new("projector light", "SPOT")
    light.energy = watts
    light.shadow_soft_size = 0.0
    light.spot_blend = 0.0
    light.spot_size = device["spot_size"]
    light.use_nodes = True
    tree = light.node_tree
    tree.nodes.clear()

    def node(kind, **values):
        made = tree.nodes.new(kind)
        for name, value in values.items():
            setattr(made, name, value)
        return made

    def math_node(operation, a, b):
        made = node("ShaderNodeMath", operation=operation)
        for socket, value in zip(made.inputs, (a, b)):
            if isinstance(value, float):
                socket.default_value = value
            else:
                tree.links.new(value, socket)
        return made.outputs[0]

    direction = node("ShaderNodeSeparateXYZ")
    tree.links.new(node("ShaderNodeTexCoord").outputs["Normal"], direction.inputs[0])
    x, y, z = direction.outputs
    # The light looks along -z with y up; pictures begin at the bottom left.
    (fu, fv), (cu, cv) = device["focal_uv"], device["principal_uv"]
    uv = node("ShaderNodeCombineXYZ")
    u = math_node("MULTIPLY", math_node("DIVIDE", x, z), -fu)
    v = math_node("MULTIPLY", math_node("DIVIDE", y, z), -fv)
    tree.links.new(math_node("ADD", u, cu), uv.inputs[0])
    tree.links.new(math_node("ADD", v, cv), uv.inputs[1])
    shown = node("ShaderNodeTexImage", image=picture, extension="CLIP", interpolation="Closest")
    emission = node("ShaderNodeEmission")
    tree.links.new(uv.outputs[0], shown.inputs[0])
    tree.links.new(shown.outputs["Color"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], node("ShaderNodeOutputLight").inputs[0])
    return placed(collection, "projector light", light, device["matrix_world"])


def add_sheet(collection, name, corners, hidden):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], [(0, 3, 2, 1)])
    sheet = placed(collection, name, mesh, Matrix())
    sheet.hide_render = hidden
    sheet.hide_viewport = hidden


def show_photo(camera, name):
    """The photograph behind the camera's view, where it is at hand."""
    folder = os.path.dirname(os.path.abspath(globals().get("__file__", "")))
    for path in (name, os.path.join(folder, name)):
        if os.path.isfile(path):
            camera.data.background_images.new().image = bpy.data.images.load(os.path.abspath(path))
            camera.data.show_background_images = True
            return


def add_cloud(collection, path):
    bpy.ops.wm.ply_import(filepath=os.path.abspath(path))
    hang(bpy.context.object, WORLD_FROM_CAMERA_MM)


def main():
    asked = arguments()
    rig = json.loads(RIG)
    scene = bpy.context.scene
    clear_startup(scene)
    collection = bpy.data.collections.new("slcal")
    scene.collection.children.link(collection)
    # All of it hangs on this one: move it, and the rig moves as a whole.
    global RIG_OBJECT
    handle = bpy.data.objects.new("rig", None)
    collection.objects.link(handle)
    RIG_OBJECT = handle.name
    camera = add_camera(scene, collection, CAMERA)
    for i, (view, corners) in enumerate(zip(rig["views"], SHEETS)):
        photo = view.get("photo") or f"view {i + 1}"
        add_sheet(collection, f"sheet of {photo}", corners, hidden=i > 0)
    if rig["views"] and rig["views"][0].get("photo"):
        show_photo(camera, rig["views"][0]["photo"])
    if PROJECTOR:
        # What the projector sees: a scene of its own, since resolution and pixel shape belong to scenes.
        seen = bpy.data.scenes.new("seen by the projector")
        seen.collection.children.link(collection)
        add_camera(seen, collection, PROJECTOR)
        if asked.picture:
            picture = bpy.data.images.load(os.path.abspath(asked.picture))
        else:
            picture = bpy.data.images.new("projector picture", PROJECTOR["width"], PROJECTOR["height"])
            picture.generated_type = "COLOR_GRID"
        add_light(collection, PROJECTOR, picture, asked.watts)
    if asked.cloud:
        add_cloud(collection, asked.cloud)
    for view_layer in [layer for s in bpy.data.scenes for layer in s.view_layers]:
        view_layer.update()


main()

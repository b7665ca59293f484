

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

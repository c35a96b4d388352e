# Run by godot3-server in a project that holds floats.glb and integers.glb, imported: what came out, one line of JSON each.
extends SceneTree

func find(node, kind):
    if node.is_class(kind):
        return node
    for child in node.get_children():
        var found = find(child, kind)
        if found:
            return found
    return null

func report_of(path):
    var scene = load(path).instance()
    var report = {}
    var instance = find(scene, "MeshInstance")
    if instance:
        var mesh = instance.mesh
        var arrays = mesh.surface_get_arrays(0)
        report["targets"] = mesh.get_blend_shape_count()
        report["vertices"] = arrays[Mesh.ARRAY_VERTEX].size()
        report["indices"] = arrays[Mesh.ARRAY_INDEX].size()
        var shapes = mesh.surface_get_blend_shape_arrays(0)
        var blend = []
        for shape in shapes:
            var vertex = shape[Mesh.ARRAY_VERTEX][0]
            blend.append([vertex.x, vertex.y, vertex.z])
        report["first_vertex"] = blend
        instance.set("blend_shapes/" + str(mesh.get_blend_shape_name(0)), 0.25)
        report["weight"] = instance.get("blend_shapes/" + str(mesh.get_blend_shape_name(0)))
        report["names"] = []
        for j in range(mesh.get_blend_shape_count()):
            report["names"].append(mesh.get_blend_shape_name(j))
    var player = find(scene, "AnimationPlayer")
    if player:
        var animation = player.get_animation(player.get_animation_list()[0])
        report["tracks"] = animation.get_track_count()
        report["length"] = animation.length
    scene.free()
    return report

func _init():
    for name in ["floats", "integers"]:
        print("REPORT ", to_json(report_of("res://" + name + ".glb")))
    quit()

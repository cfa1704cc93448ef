/* rt_digest.h -- RT_TYPES_DIGEST, a hash of sizes and offsets of all fields of version 2 of the ABI. It shows a plugin that was
 * compiled with another layout: with packed structs, for another machine, or with a header that someone edited. Fields that are
 * appended later are not in it, so the number is the same in all headers of version 2. Included by rt_plugin.h. */
#ifndef RT_DIGEST_H
#define RT_DIGEST_H
#define RT_MIX1(h, a) ((h)*16777619u + (rt_u32)(a))
#define RT_MIX2(h, a, b) RT_MIX1(RT_MIX1(h, a), b)
#define RT_MIX4(h, a, b, c, d) RT_MIX2(RT_MIX2(h, a, b), c, d)
#define RT_OF1(h, type, a) RT_MIX1((rt_u32)(h), offsetof(type, a))
#define RT_OF2(h, type, a, b) RT_OF1(RT_OF1(h, type, a), type, b)
#define RT_OF4(h, type, a, b, c, d) RT_OF2(RT_OF2(h, type, a, b), type, c, d)
/* Where version 2 ends in a struct that may grow. */
#define RT_END(type, last) (offsetof(type, last) + sizeof(((const type *)0)->last))

#define RT_DIGEST_PACKED_PRIM RT_OF2(RT_OF4(sizeof(rt_packed_prim), rt_packed_prim, a, ref, b, material), rt_packed_prim, c, \
    prim)
#define RT_DIGEST_HOST RT_OF2(RT_OF4(RT_END(rt_host, parallel_for), rt_host, struct_bytes, ctx, fail, log), rt_host, progress, \
    parallel_for)
#define RT_DIGEST_PARAM RT_OF1(RT_OF4(RT_OF4(RT_END(rt_param, choices), rt_param, key, label, help, kind), rt_param, effect, \
    min, max, def), rt_param, choices)
#define RT_DIGEST_PRIM RT_OF4(sizeof(rt_prim), rt_prim, lo, ref, hi, mesh)
#define RT_DIGEST_GROUP RT_OF2(sizeof(rt_group), rt_group, first, count)
#define RT_DIGEST_GEOMETRY RT_OF1(RT_OF2(RT_END(rt_geometry, triangle_count), rt_geometry, struct_bytes, triangles), \
    rt_geometry, triangle_count)
#define RT_DIGEST_DEVICE RT_OF1(RT_OF4(RT_OF4(RT_END(rt_device, memory_bytes), rt_device, struct_bytes, kind, lanes, \
    compute_units), rt_device, cache_line_bytes, local_bytes, unit_cache_bytes, shared_cache_bytes), rt_device, memory_bytes)
#define RT_DIGEST_BUILD_INPUT RT_OF2(RT_OF4(RT_OF4(RT_END(rt_build_input, first_leaf), rt_build_input, struct_bytes, \
    group_count, prims, groups), rt_build_input, geometry, params, device, wanted), rt_build_input, first_elements, \
    first_leaf)
#define RT_DIGEST_BUILD_OUTPUT RT_OF1(RT_OF2(RT_OF4(RT_END(rt_build_output, stat), rt_build_output, struct_bytes, ctx, alloc, \
    leaves), rt_build_output, root, define), rt_build_output, stat)
#define RT_DIGEST_SLOT RT_OF4(RT_END(rt_slot, flags), rt_slot, name, cl_type, elem_bytes, flags)
#define RT_DIGEST_CL_FILE RT_OF2(sizeof(rt_cl_file), rt_cl_file, name, text)
#define RT_DIGEST_BUILT RT_OF1(RT_OF4(RT_END(rt_built, roots), rt_built, struct_bytes, group_count, slots, slot_counts), \
    rt_built, roots)
#define RT_DIGEST_VOLUME_SINK RT_OF4(RT_END(rt_volume_sink, sphere), rt_volume_sink, struct_bytes, ctx, box, sphere)
#define RT_DIGEST_TOPOLOGY_NODE RT_OF4(sizeof(rt_topology_node), rt_topology_node, lo, left, hi, right)
#define RT_DIGEST_TOPOLOGY_OUTPUT RT_OF2(RT_OF4(RT_END(rt_topology_output, stat), rt_topology_output, struct_bytes, ctx, \
    nodes, refs), rt_topology_output, root, stat)
#define RT_DIGEST_TOPOLOGY RT_OF1(RT_OF2(RT_OF4(RT_END(rt_topology, roots), rt_topology, struct_bytes, group_count, nodes, \
    node_count), rt_topology, refs, ref_count), rt_topology, roots)
#define RT_DIGEST_ACCEL RT_OF4(RT_OF4(RT_OF4(RT_OF4(RT_END(rt_accel, ray_cost), rt_accel, struct_bytes, kernel_contract, \
    slot_count, slot_bytes), rt_accel, slots, types, traverse, build), rt_accel, levels, pack, layout, topology), rt_accel, \
    capabilities, merit_cpu, merit_gpu, ray_cost)
#define RT_DIGEST_MESH RT_OF1(RT_OF2(RT_OF4(RT_OF4(RT_OF4(RT_END(rt_mesh, face_materials), rt_mesh, struct_bytes, material, \
    name, positions), rt_mesh, vertex_count, position_stride, normals, normal_stride), rt_mesh, uvs, uv_stride, indices, \
    index_count), rt_mesh, face_sizes, face_count), rt_mesh, face_materials)
#define RT_DIGEST_INSTANCE_DESC RT_OF1(RT_OF4(RT_END(rt_instance_desc, world_from_object), rt_instance_desc, struct_bytes, \
    name, mesh, material), rt_instance_desc, world_from_object)
#define RT_DIGEST_MATERIAL_DESC RT_OF1(RT_OF2(RT_OF4(RT_OF4(RT_END(rt_material_desc, texture), rt_material_desc, struct_bytes, \
    flags, name, color), rt_material_desc, reflect, emission, refract, specular), rt_material_desc, shininess, ior), \
    rt_material_desc, texture)
#define RT_DIGEST_TEXTURE_DESC RT_OF2(RT_OF4(RT_END(rt_texture_desc, height), rt_texture_desc, struct_bytes, path, bytes, \
    byte_count), rt_texture_desc, width, height)
#define RT_DIGEST_CAMERA RT_OF2(RT_OF4(RT_END(rt_camera, fov_y_rad), rt_camera, struct_bytes, name, eye, target), rt_camera, \
    up, fov_y_rad)
#define RT_DIGEST_LIGHT_DESC RT_OF1(RT_OF2(RT_OF4(RT_END(rt_light_desc, pad), rt_light_desc, struct_bytes, kind, name, \
    position), rt_light_desc, direction, color), rt_light_desc, pad)
#define RT_DIGEST_LOAD RT_OF2(RT_OF4(RT_END(rt_load, where), rt_load, struct_bytes, path, name, world_from_object), rt_load, \
    material, where)
#define RT_DIGEST_SCENE_INFO RT_OF1(RT_OF4(RT_END(rt_scene_info, ambient), rt_scene_info, struct_bytes, up_axis, unit_scale, \
    background), rt_scene_info, ambient)
#define RT_DIGEST_SCENE_SINK RT_OF2(RT_OF4(RT_OF4(RT_OF4(RT_END(rt_scene_sink, load), rt_scene_sink, struct_bytes, ctx, \
    texture, material), rt_scene_sink, mesh, instance, sphere, plane), rt_scene_sink, polygon, light, camera, info), \
    rt_scene_sink, warn, load)
#define RT_DIGEST_IMPORTER RT_OF4(RT_END(rt_importer, load), rt_importer, struct_bytes, extensions, probe, load)
#define RT_DIGEST_EXTENSION RT_OF4(RT_END(rt_extension, data), rt_extension, name, version, data_bytes, data)
#define RT_DIGEST_PLUGIN RT_OF2(RT_OF4(RT_OF4(RT_OF4(RT_END(rt_plugin, extension_bytes), rt_plugin, abi_version, struct_bytes, \
    types_digest, param_count), rt_plugin, id, name, version, reference), rt_plugin, params, accel, importer, extensions), \
    rt_plugin, param_bytes, extension_bytes)

#define RT_TYPES_DIGEST RT_MIX1(RT_MIX4(RT_MIX4(RT_MIX4(RT_MIX4(RT_MIX4(RT_MIX4(RT_MIX4(0u, RT_DIGEST_PACKED_PRIM, \
    RT_DIGEST_HOST, RT_DIGEST_PARAM, RT_DIGEST_PRIM), RT_DIGEST_GROUP, RT_DIGEST_GEOMETRY, RT_DIGEST_DEVICE, \
    RT_DIGEST_BUILD_INPUT), RT_DIGEST_BUILD_OUTPUT, RT_DIGEST_SLOT, RT_DIGEST_CL_FILE, RT_DIGEST_BUILT), \
    RT_DIGEST_VOLUME_SINK, RT_DIGEST_TOPOLOGY_NODE, RT_DIGEST_TOPOLOGY_OUTPUT, RT_DIGEST_TOPOLOGY), RT_DIGEST_ACCEL, \
    RT_DIGEST_MESH, RT_DIGEST_INSTANCE_DESC, RT_DIGEST_MATERIAL_DESC), RT_DIGEST_TEXTURE_DESC, RT_DIGEST_CAMERA, \
    RT_DIGEST_LIGHT_DESC, RT_DIGEST_LOAD), RT_DIGEST_SCENE_INFO, RT_DIGEST_SCENE_SINK, RT_DIGEST_IMPORTER, \
    RT_DIGEST_EXTENSION), RT_DIGEST_PLUGIN)
#endif

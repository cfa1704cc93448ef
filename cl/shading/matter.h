/* matter.h -- RT_MODEL_GLTF at a hit: all values of the surface, before lobes are made of them. */
#ifndef RT_MATTER_H
#define RT_MATTER_H
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)

/* Members are those of rt_material and rt_layers of the same name, in each lane and after textures. */
typedef struct rt_matter {
    rt_vec color, specular_color;
    vfloat roughness, metallic, specular_weight, transmission;
    vfloat ior;
    vmask solid; /* RT_LAYERS_SOLID */
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    vfloat clearcoat, clearcoat_roughness;
    rt_vec coat_normal; /* unit; in the frame of the shading normal, which is z */
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    rt_vec sheen_color;
    vfloat sheen_roughness;
#endif
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    vfloat anisotropy;
    vfloat grain_x, grain_y; /* unit: the grain, along tangent and bitangent */
#endif
#if RT_MAY_SCATTER(RT_LOBE_FILM)
    vfloat iridescence, iridescence_ior, iridescence_thickness;
#endif
} rt_matter;

RT_INLINE rt_matter rt_no_matter(void)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    rt_matter m;
    m.color = m.specular_color = rt_splat(0.0f, 0.0f, 0.0f);
    m.roughness = m.metallic = m.specular_weight = m.transmission = zero;
    m.ior = one;
    m.solid = rt_vint(0);
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    m.clearcoat = m.clearcoat_roughness = zero;
    m.coat_normal = rt_splat(0.0f, 0.0f, 1.0f);
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    m.sheen_color = m.color;
    m.sheen_roughness = zero;
#endif
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    m.anisotropy = m.grain_y = zero;
    m.grain_x = one;
#endif
#if RT_MAY_SCATTER(RT_LOBE_FILM)
    m.iridescence = m.iridescence_thickness = zero;
    m.iridescence_ior = one;
#endif
    return m;
}

#endif
#endif

// Textures that a user gives to materials.
#include "scene/map_edit.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "scene/material_keys.hpp"

namespace clarity {
namespace {

// Materials 1 and 2; the first has a colour that lies scaled, and texture 1 for nothing.
Scene two_materials() {
    Scene scene;
    scene.materials.resize(3);
    for (Material& material : scene.materials) material.values = default_material();
    rt_texture picture{};
    picture.width = picture.height = 1;
    scene.textures = {picture, picture, picture};
    scene.textures[1].first = 1;
    scene.textures[2].first = 2;
    scene.textures[2].flags = RT_TEXTURE_LINEAR;
    scene.texture_names = {"wood", "", "/pictures/bumps.png"};
    scene.texels = {1, 2, 3};
    rt_map map{};
    map.matrix[0] = map.matrix[4] = 4;
    map.scale = 1;
    scene.maps = {map};
    scene.materials[1].maps[RT_MAP_COLOR] = 0;
    scene.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    scene.uvs = {0, 0, 1, 0, 0, 1};
    scene.triangles = {0, 1, 2};
    scene.triangle_materials = {1};
    scene.meshes.push_back({"", 0, 3, 0, 1, 1});
    scene.instances.resize(1);
    return scene;
}

TEST(MapEdits, WhatTheSceneHasIsNoEdit) {
    const Scene scene = two_materials();
    MapEdits edits;
    edits.give(scene, 1, RT_MAP_COLOR, 0);
    EXPECT_TRUE(edits.empty());
    edits.give(scene, 1, RT_MAP_COLOR, RT_NONE);
    edits.give(scene, 2, RT_MAP_EMISSION, 1);
    edits.give(scene, 1, RT_MAP_NORMAL, 2);
    EXPECT_EQ(edits.given.size(), 3u);
    EXPECT_EQ(edits.texture_of(scene, 1, RT_MAP_COLOR), RT_NONE);
    EXPECT_EQ(edits.texture_of(scene, 1, RT_MAP_NORMAL), 2u);
    EXPECT_EQ(MapEdits().texture_of(scene, 1, RT_MAP_COLOR), 0u);
    edits.give(scene, 1, RT_MAP_COLOR, 0);
    edits.give(scene, 2, RT_MAP_EMISSION, RT_NONE);
    edits.reset(1);
    EXPECT_TRUE(edits.empty());
}

TEST(MapEdits, AnotherPictureLiesWhereTheFirstDid) {
    const Scene scene = two_materials();
    MapEdits edits;
    edits.give(scene, 1, RT_MAP_COLOR, 1);
    edits.give(scene, 1, RT_MAP_NORMAL, 2);
    edits.give(scene, 2, RT_MAP_COLOR, 1);
    const Scene with = with_maps(scene, edits);
    const rt_map& color = with.maps.at(with.materials[1].maps[RT_MAP_COLOR]);
    EXPECT_EQ(color.texture, 1u);
    EXPECT_EQ(color.matrix[0], 4);
    EXPECT_EQ(with.maps.at(with.materials[1].maps[RT_MAP_NORMAL]).matrix[4], 4) << "as the colour's";
    EXPECT_EQ(with.materials[2].values.texture, 1u) << "a colour without a transform needs no map";
    EXPECT_EQ(with.materials[2].maps, no_maps());
    EXPECT_EQ(with.tangents.size(), 3u);
    EXPECT_NE(with.tangents[0], 0u);
    EXPECT_TRUE(with.texels.shares(scene.texels));
    EXPECT_TRUE(same_geometry(scene, with));
    EXPECT_EQ(validate(with).text(), "");
    Scene moved = with;
    moved.instances[0].world_from_object[3] = 1;
    EXPECT_FALSE(same_geometry(scene, moved));
    Scene passed = with;
    passed.instances[0].mask = RT_SEEN_BY_ALL & ~RT_SEEN_BY_CAMERA;
    EXPECT_FALSE(same_geometry(scene, passed)) << "a mesh with a mask is not flattened";
}

TEST(MapEdits, ThePictureIsOfTheColourSpaceOfItsUse) {
    const Scene scene = two_materials();
    MapEdits edits;
    edits.give(scene, 2, RT_MAP_COLOR, 2);
    edits.give(scene, 1, RT_MAP_EMISSION, 2);
    edits.give(scene, 2, RT_MAP_METALLIC_ROUGHNESS, 0);
    const Scene with = with_maps(scene, edits);
    ASSERT_EQ(with.textures.size(), 5u) << "one for two uses of a space";
    EXPECT_EQ(with.materials[2].values.texture, with.maps.at(with.materials[1].maps[RT_MAP_EMISSION]).texture);
    EXPECT_EQ(with.textures[with.materials[2].values.texture].flags, 0u);
    EXPECT_EQ(with.textures[with.materials[2].values.texture].first, 2u);
    EXPECT_EQ(with.textures[with.maps.at(with.materials[2].maps[RT_MAP_METALLIC_ROUGHNESS]).texture].flags,
              rt_u32(RT_TEXTURE_LINEAR));
    EXPECT_EQ(validate(with).text(), "");
}

TEST(MapEdits, WordsFindTheTextureAgain) {
    Scene scene = two_materials();
    scene.textures.push_back(scene.textures[0]);
    scene.textures.back().flags = RT_TEXTURE_LINEAR;
    scene.texture_names.push_back("wood");
    for (const rt_u32 use : {RT_MAP_COLOR, RT_MAP_NORMAL})
        for (rt_u32 texture = 0; texture < scene.textures.size(); ++texture)
            EXPECT_EQ(find_texture(scene, texture_word(scene, texture, use), use), texture);
    EXPECT_EQ(find_texture(scene, "wood", RT_MAP_COLOR), 0u);
    EXPECT_EQ(find_texture(scene, "wood", RT_MAP_NORMAL), 3u);
    EXPECT_EQ(find_texture(scene, "/pictures/../pictures/bumps.png", RT_MAP_COLOR), 2u);
    EXPECT_EQ(find_texture(scene, "9", RT_MAP_COLOR), RT_NONE);
    EXPECT_EQ(find_texture(scene, "stone", RT_MAP_COLOR), RT_NONE);
    EXPECT_EQ(texture_word(scene, RT_NONE, RT_MAP_COLOR), "none");
}

}  // namespace
}  // namespace clarity

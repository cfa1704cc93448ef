// The structs of today begin as those of the frozen header.
#include <gtest/gtest.h>

#include <map>

#include "layout.hpp"
#include "plugin/abi_struct.hpp"

namespace {

TEST(FrozenLayout, FieldsKeepTheirPlaces) {
    const AbiLayout then = layout_then(), now = layout_now();
    ASSERT_EQ(then.structs.size(), now.structs.size());
    for (size_t s = 0; s < then.structs.size(); ++s) {
        const StructLayout &was = then.structs[s], &is = now.structs[s];
        SCOPED_TRACE(was.name);
        if (was.grows)
            EXPECT_GE(is.bytes, was.bytes);
        else
            EXPECT_EQ(is.bytes, was.bytes) << "this struct must not grow";
        for (size_t f = 0; f < was.fields.size(); ++f) {
            EXPECT_EQ(is.fields[f].offset, was.fields[f].offset) << was.fields[f].name;
            EXPECT_EQ(is.fields[f].bytes, was.fields[f].bytes) << was.fields[f].name;
        }
    }
}

// A field that is appended must not take the place of padding, which a plugin may have left undefined.
TEST(FrozenLayout, StructsHaveNoPaddingAtTheirEnds) {
    for (const StructLayout& was : layout_then().structs)
        EXPECT_EQ(was.fields.back().offset + was.fields.back().bytes, was.bytes) << was.name;
}

TEST(FrozenLayout, NumbersAreTheSame) {
    const AbiLayout then = layout_then(), now = layout_now();
    EXPECT_EQ(then.version, 2u);
    EXPECT_EQ(then.contract, 1u);
    if (now.version == 2) {
        EXPECT_EQ(now.digest, then.digest) << "fields that are appended must not be in the digest";
    }
    EXPECT_EQ(then.digest, 0x25e77114u) << "of machines with 64 bits";
}

TEST(FrozenLayout, TheHostAsksForNoMore) {
    std::map<std::string, size_t> was;
    for (const StructLayout& s : layout_then().structs) was[s.name] = s.bytes;
    EXPECT_EQ(was["rt_plugin"], clarity::kLeastBytes<rt_plugin>);
    EXPECT_EQ(was["rt_accel"], clarity::kLeastBytes<rt_accel>);
    EXPECT_EQ(was["rt_importer"], clarity::kLeastBytes<rt_importer>);
    EXPECT_EQ(was["rt_param"], clarity::kLeastBytes<rt_param>);
    EXPECT_EQ(was["rt_slot"], clarity::kLeastBytes<rt_slot>);
    EXPECT_EQ(was["rt_extension"], clarity::kLeastBytes<rt_extension>);
    EXPECT_EQ(was["rt_mesh"], clarity::kLeastBytes<rt_mesh>);
    EXPECT_EQ(was["rt_instance_desc"], clarity::kLeastBytes<rt_instance_desc>);
    EXPECT_EQ(was["rt_material_desc"], clarity::kLeastBytes<rt_material_desc>);
    EXPECT_EQ(was["rt_texture_desc"], clarity::kLeastBytes<rt_texture_desc>);
    EXPECT_EQ(was["rt_camera"], clarity::kLeastBytes<rt_camera>);
    EXPECT_EQ(was["rt_light_desc"], clarity::kLeastBytes<rt_light_desc>);
    EXPECT_EQ(was["rt_load"], clarity::kLeastBytes<rt_load>);
    EXPECT_EQ(was["rt_scene_info"], clarity::kLeastBytes<rt_scene_info>);
}

}  // namespace

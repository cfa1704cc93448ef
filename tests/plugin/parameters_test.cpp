#include "plugin/parameters.hpp"

#include <gtest/gtest.h>

#include <clocale>
#include <limits>

#include "base/error.hpp"
#include "rt_plugin.hpp"
#include "support/errors.hpp"

namespace {

const char* const kSplits[] = {"sah", "half", "1", nullptr};  // the last name is also the index of another choice
constexpr rt_param kTreeParams[] = {
    rt::int_param("max_leaf", "Max leaf size", "primitives in a leaf, at most", 1, 16, 4),
    rt::float_param("cost", "Traversal cost", "relative to a leaf test", 0.0625, 2500, 1.5),
    rt::bool_param("packed", "Packed", "store triangles in the nodes", false, RT_EFFECT_RECOMPILE),
    rt::enum_param("split", "Split", "where a node is divided", kSplits, 1),
};
constexpr rt_accel kTree = rt::topology("tree", nullptr, rt::Traits());
constexpr rt_plugin kTreePlugin = rt::accel_plugin("bvh2", "A tree", "1.0", nullptr, kTreeParams, kTree);
constexpr rt_plugin kPlain = rt::accel_plugin("plain", "No parameters", "1.0", nullptr, kTree);

double set(const std::string& key, const std::string& value) {
    clarity::ParameterValues values = clarity::default_parameters(kTreePlugin);
    clarity::set_parameter(kTreePlugin, values, key, value);
    for (size_t i = 0; i < values.size(); ++i)
        if (key == kTreeParams[i].key) return values[i];
    return std::numeric_limits<double>::quiet_NaN();
}

// The message of the Error(usage) which the call throws.
template <class Call>
std::string usage_error(Call call) {
    return clarity::expect_error(call, {}, clarity::Exit::usage);
}

TEST(Parameters, Defaults) {
    EXPECT_EQ(clarity::default_parameters(kTreePlugin), (clarity::ParameterValues{4, 1.5, 0, 1}));
    EXPECT_TRUE(clarity::default_parameters(kPlain).empty());
}

TEST(Parameters, ReadsEachKind) {
    EXPECT_EQ(set("max_leaf", "1"), 1);
    EXPECT_EQ(set("max_leaf", "16"), 16);
    EXPECT_EQ(set("max_leaf", "+8"), 8);
    EXPECT_EQ(set("max_leaf", "8.0"), 8);
    EXPECT_EQ(set("cost", "2.5e3"), 2500);
    EXPECT_EQ(set("cost", ".5"), 0.5);
    for (const char* yes : {"1", "true", "on"}) EXPECT_EQ(set("packed", yes), 1) << yes;
    for (const char* no : {"0", "false", "off"}) EXPECT_EQ(set("packed", no), 0) << no;
    EXPECT_EQ(set("split", "sah"), 0);
    EXPECT_EQ(set("split", "half"), 1);
}

TEST(Parameters, NamesOfChoicesComeBeforeIndices) {
    EXPECT_EQ(set("split", "1"), 2);
    EXPECT_EQ(set("split", "0"), 0);
}

TEST(Parameters, RefusesWhatIsOutOfRangeOrNoNumber) {
    for (const char* bad : {"0", "17", "-1", "2.5", "", "four", "4x", "nan", "inf", "1e400", "0x4", "4 ", " 4", "4,5"}) {
        const std::string what = usage_error([&] { set("max_leaf", bad); });
        EXPECT_NE(what.find("bvh2: max_leaf=" + std::string(bad) + ":"), std::string::npos) << what;
        EXPECT_NE(what.find("from 1 to 16"), std::string::npos) << what;
        EXPECT_NE(what.find("default 4"), std::string::npos) << what;
    }
    EXPECT_NE(usage_error([] { set("cost", "0.05"); }).find("from 0.0625 to 2500"), std::string::npos)
        << usage_error([] { set("cost", "0.05"); });
    EXPECT_NE(usage_error([] { set("packed", "2"); }).find("true, false"), std::string::npos);
    for (const char* bad : {"median", "3", "-1", "0.5", "SAH"})
        EXPECT_NE(usage_error([&] { set("split", bad); }).find("one of sah, half, 1"), std::string::npos) << bad;
}

TEST(Parameters, AFailedSettingChangesNothing) {
    clarity::ParameterValues values = clarity::default_parameters(kTreePlugin);
    const clarity::ParameterValues before = values;
    EXPECT_THROW(clarity::set_parameter(kTreePlugin, values, "max_leaf", "99"), clarity::Error);
    EXPECT_EQ(values, before);
}

TEST(Parameters, AnUnknownKeyIsAnErrorThatListsTheKeys) {
    const std::string what = usage_error([] { set("leaf", "4"); });
    for (const char* word : {"bvh2", "'leaf'", "max_leaf", "cost", "packed", "split"})
        EXPECT_NE(what.find(word), std::string::npos) << what;
    clarity::ParameterValues none;
    EXPECT_NE(usage_error([&] { clarity::set_parameter(kPlain, none, "leaf", "4"); }).find("none at all"), std::string::npos);
}

TEST(Parameters, TextReadsBackAsTheSameValue) {
    clarity::ParameterValues values = {7, 0.1, 1, 2};
    const char* expected[] = {"max_leaf=7", "cost=0.1", "packed=true", "split=1"};
    for (size_t i = 0; i < values.size(); ++i) {
        const std::string text = clarity::parameter_text(kTreePlugin, values, i);
        EXPECT_EQ(text, expected[i]);
        clarity::ParameterValues read = clarity::default_parameters(kTreePlugin);
        const size_t equals = text.find('=');
        clarity::set_parameter(kTreePlugin, read, text.substr(0, equals), text.substr(equals + 1));
        EXPECT_EQ(read[i], values[i]);
    }
    EXPECT_EQ(clarity::parameter_text(kTreePlugin, values, 4), "");
}

TEST(PluginChoice, IdAndSettings) {
    const clarity::PluginChoice plain = clarity::parse_plugin_choice("bvh2");
    EXPECT_EQ(plain.id, "bvh2");
    EXPECT_TRUE(plain.settings.empty());
    const clarity::PluginChoice choice = clarity::parse_plugin_choice("bvh2,max_leaf=4,split=a=b");
    EXPECT_EQ(choice.id, "bvh2");
    ASSERT_EQ(choice.settings.size(), 2u);
    EXPECT_EQ(choice.settings[0], (std::pair<std::string, std::string>("max_leaf", "4")));
    EXPECT_EQ(choice.settings[1], (std::pair<std::string, std::string>("split", "a=b")));
}

TEST(PluginChoice, RefusesWhatIsMalformed) {
    for (const char* bad : {"", ",", "bvh2,", "bvh2,,max_leaf=4", "bvh2,max_leaf", "bvh2,=4", "bvh2,max_leaf=", "max_leaf=4",
                            ",max_leaf=4", "bvh2,max_leaf=4,max_leaf=5"}) {
        const std::string what = usage_error([&] { clarity::parse_plugin_choice(bad); });
        EXPECT_NE(what.find("ID[,key=value...]"), std::string::npos) << what;
        EXPECT_EQ(what.find("'" + std::string(bad) + "'"), 0u) << what;
    }
}

// The decimal comma of the user's locale must not change how numbers are read or printed.
TEST(Parameters, DoNotDependOnTheLocale) {
    const std::string before = std::setlocale(LC_NUMERIC, nullptr);
    if (!std::setlocale(LC_NUMERIC, "de_DE.UTF-8")) GTEST_SKIP() << "the locale de_DE.UTF-8 is not installed";
    EXPECT_EQ(set("cost", "0.5"), 0.5);
    EXPECT_EQ(clarity::parameter_text(kTreePlugin, {4, 0.5, 0, 0}, 1), "cost=0.5");
    std::setlocale(LC_NUMERIC, before.c_str());
}

}  // namespace

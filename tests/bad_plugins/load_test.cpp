// Libraries that the loader refuses, and whether its message gives the reason.
#include <dlfcn.h>
#include <elf.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <set>

#include "plugin/abi_struct.hpp"
#include "plugin/elf_file.hpp"
#include "plugin/registry.hpp"
#include "support/scratch.hpp"

namespace {

namespace fs = std::filesystem;

std::string library(const std::string& name) {
    return std::string(BAD_PLUGINS) + "/" + name + ".so";
}

std::string read_file(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
}

struct Refusal {
    const char* file;
    std::vector<const char*> says;
};
void PrintTo(const Refusal& refusal, std::ostream* out) {
    *out << refusal.file;
}

class BadPlugin : public testing::TestWithParam<Refusal> {};

TEST_P(BadPlugin, IsRefusedWithAReason) {
    const std::string path = library(GetParam().file);
    ASSERT_TRUE(fs::exists(path)) << path;
    const clarity::PluginRecord record = clarity::load_plugin(path);
    EXPECT_EQ(record.plugin, nullptr);
    EXPECT_EQ(record.path, path);
    for (const char* words : GetParam().says)
        EXPECT_NE(record.why.find(words), std::string::npos) << words << "\nin: " << record.why;
    EXPECT_EQ(record.why.find('\n'), std::string::npos) << "one line: " << record.why;
    EXPECT_EQ(record.why.find('\033'), std::string::npos) << "no control characters";
}

const Refusal kRefusals[] = {
    {"wrong_abi", {"ABI version 3", "this host speaks 2", "rebuild"}},
    {"first_abi", {"ABI version 1", "this host speaks 2", "rebuild"}},
    {"old_abi", {"ABI version 0", "this host speaks 2", "rebuild"}},
    {"not_constant", {"zero in the file", "constexpr"}},
    {"aborts_when_loaded", {"ABI version 3", "this host speaks 2"}},
    {"crashes_when_loaded", {"crashed the process that opened it (aborted", "build it or copy it again"}},
    {"wrong_digest", {"digest", "0x", "rt_plugin.h", "rebuild"}},
    {"small_struct", {"rt_plugin has struct_bytes 80", "ABI version 2 has 88", "rebuild"}},
    {"large_struct", {"struct_bytes", "exports", "bytes"}},
    {"no_symbol", {"no symbol rt_plugin_v1", "docs/plugins.md"}},
    {"hidden_symbol", {"no symbol rt_plugin_v1"}},
    {"function_symbol", {"as a function", "expected data"}},
    {"undefined_function", {"cannot be loaded", "sound_function_that_nobody_has", "--no-undefined"}},
    {"bad_id", {"'Sound-1'", "[a-z][a-z0-9_]*"}},
    {"null_id", {"id", "[a-z][a-z0-9_]*"}},
    {"control_characters", {"name holds control characters"}},
    {"both_kinds", {"more than one of accel, importer and primitive", "exactly one"}},
    {"neither_kind", {"neither", "exactly one"}},
    {"small_accel", {"rt_accel has struct_bytes 104", "ABI version 2 has 112", "rebuild"}},
    {"small_importer", {"rt_importer has struct_bytes 8", "has 32"}},
    {"no_build", {"build is NULL"}},
    {"small_param", {"rt_param has param_bytes 56", "has 64", "rebuild"}},
    {"odd_param", {"rt_param has param_bytes 65", "sizeof(rt_param)"}},
    {"no_param_size", {"rt_param has param_bytes 0", "sizeof(rt_param)"}},
    {"small_slot", {"rt_slot has slot_bytes 16", "has 24"}},
    {"small_extension", {"rt_extension has extension_bytes 8", "has 24"}},
    {"extension_without_data", {"'refit'", "data_bytes 16", "NULL"}},
    {"small_refit", {"rt_refit has data_bytes 8", "has 16"}},
    {"refit_without_function", {"'refit'", "function refit is NULL"}},
    {"small_device_build", {"rt_device_build has data_bytes 56", "has 64"}},
    {"device_build_without_kernels", {"'device_build'", "has no text", "_build.cl"}},
    {"device_build_of_nothing", {"'device_build'", "topology, pack and refit", "NULL"}},
    {"device_pack_without_elements", {"'device_build'", "pack goes with elements"}},
    {"device_refit_without_ranges", {"'device_build'", "refit goes with ranges"}},
    {"endless_extensions", {"extensions", "at the end"}},
    {"later_contract", {"version 2 of the kernel contract", "offers 1", "update clarity"}},
    {"no_contract", {"version 0 of the kernel contract", "offers 1", "RT_KERNEL_CONTRACT"}},
    {"host_only_nodes", {"slot 0", "RT_SLOT_HOST_ONLY", "roots"}},
    {"topology_of_no_layout", {"topology", "`layout`", "bvh2"}},
    {"topology_with_kernels", {"layout is 'bvh2'", "leave its own 0"}},
    {"layout_of_no_topology", {"layout is 'bvh2'", "topology is NULL"}},
    {"layout_of_odd_name", {"`layout`", "id"}},
    {"no_traversal", {"traversal has no text", "embed"}},
    {"merit_not_a_number", {"merit_gpu is nan", "0 or more"}},
    {"merit_below_zero", {"merit_cpu is -1", "0 or more"}},
    {"unknown_ray_cost", {"ray_cost is 7"}},
    {"slots_of_one_name", {"two slots", "'sound_nodes'"}},
    {"slot_of_no_size", {"'sound_nodes'", "elem_bytes 0"}},
    {"slot_of_odd_name", {"slot 0", "identifier"}},
    {"slot_of_no_type", {"'sound_nodes'", "cl_type"}},
    {"params_of_one_key", {"two parameters 'leaf'"}},
    {"param_out_of_range", {"'leaf'", "min <= def <= max", "17"}},
    {"param_not_a_number", {"'leaf'", "finite", "nan"}},
    {"param_not_whole", {"'leaf'", "whole"}},
    {"param_of_unknown_kind", {"'leaf'", "kind 9"}},
    {"param_without_help", {"'leaf'", "help is missing"}},
    {"enum_without_choices", {"'split'", "choices"}},
    {"enum_of_wrong_range", {"'split'", "range must be 0..1"}},
    {"null_params", {"params is NULL"}}};
INSTANTIATE_TEST_SUITE_P(Defects, BadPlugin, testing::ValuesIn(kRefusals),
                         [](const testing::TestParamInfo<Refusal>& info) { return info.param.file; });

// The same parts without a defect are accepted. This shows that the libraries above are refused because of the defect.
TEST(GoodPlugin, IsAccepted) {
    for (const char* name : {"sound", "bad_builder", "unknown_capability", "unknown_extension"}) {
        const clarity::PluginRecord record = clarity::load_plugin(library(name));
        ASSERT_NE(record.plugin, nullptr) << record.why;
        EXPECT_EQ(record.why, "");
        EXPECT_STREQ(record.plugin->id, name);
    }
}

TEST(GoodPlugin, MayComeFromALaterSdkWithLongerStructs) {
    const clarity::PluginRecord record = clarity::load_plugin(library("grown_struct"));
    ASSERT_NE(record.plugin, nullptr) << record.why;
    const rt_plugin& plugin = *record.plugin;
    EXPECT_GT(plugin.struct_bytes, sizeof(rt_plugin));
    ASSERT_EQ(plugin.param_count, 2u);
    EXPECT_STREQ(plugin.params[0].key, "max_leaf");
    EXPECT_STREQ(plugin.params[1].key, "bins") << "the second element begins where the plugin says";
    EXPECT_EQ(plugin.params[1].max, 32);
    ASSERT_EQ(plugin.accel->slot_count, 2u);
    EXPECT_STREQ(plugin.accel->slots[1].name, "sound_boxes");
    EXPECT_STREQ(plugin.extensions[0].name, "org.example.later");
    EXPECT_EQ(plugin.extensions[1].name, nullptr);
}

// A later host's structs are longer than those of a plugin of today.
TEST(GoodPlugin, MayComeFromAnEarlierSdkWithShorterStructs) {
    struct Later {
        rt_slot known;
        double more[2];
    };
    const rt_slot slots[2] = {{"nodes", "uint", 4, 7}, {"others", "uint", 4, 7}};
    const auto later = clarity::copied<Later>(slots, sizeof slots[0]);
    EXPECT_STREQ(later.known.name, "nodes");
    EXPECT_EQ(later.known.flags, 7u);
    EXPECT_EQ(later.more[0], 0) << "not what lies behind the plugin's struct";
    EXPECT_EQ(later.more[1], 0);
}

TEST(GoodPlugin, IsTheSameWhenItIsLoadedAgain) {
    EXPECT_EQ(clarity::load_plugin(library("sound")).plugin, clarity::load_plugin(library("sound")).plugin);
}

// If this library were loaded, it would end the process. So its refusal above proves that it was not loaded.
TEST(AbortsWhenLoadedDeathTest, IsArmed) {
    EXPECT_DEATH(dlopen(library("aborts_when_loaded").c_str(), RTLD_NOW | RTLD_LOCAL), "");
}

// Every defect that is compiled must be tested above: an untested one would look as if it were refused.
TEST(BadPlugins, AllAreTested) {
    std::set<std::string> compiled, tested = {"sound", "grown_struct", "unknown_capability", "unknown_extension"};
    const std::string text = read_file(std::string(CLARITY_SOURCE_DIR) + "/tests/bad_plugins/libraries/defects.c"),
                      word = "DEFECT_";
    for (size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) {
        const size_t begin = at + word.size(), end = text.find_first_not_of("abcdefghijklmnopqrstuvwxyz_", begin);
        if (end > begin) compiled.insert(text.substr(begin, end - begin));
    }
    for (const Refusal& refusal : kRefusals) tested.insert(refusal.file);
    EXPECT_EQ(compiled, tested);
}

TEST(NoPlugin, TextFile) {
    const Scratch scratch;
    const clarity::PluginRecord record = clarity::load_plugin(scratch.write("text.so", "INPUT(libreal.so)\n"));
    EXPECT_EQ(record.plugin, nullptr);
    EXPECT_NE(record.why.find("not a shared library"), std::string::npos) << record.why;
}

TEST(NoPlugin, EmptyFile) {
    const Scratch scratch;
    const clarity::PluginRecord record = clarity::load_plugin(scratch.write("empty.so", ""));
    EXPECT_EQ(record.plugin, nullptr);
    EXPECT_NE(record.why.find("empty file"), std::string::npos) << record.why;
}

TEST(NoPlugin, MissingFile) {
    const Scratch scratch;
    const clarity::PluginRecord record = clarity::load_plugin(scratch.path("none.so"));
    EXPECT_EQ(record.plugin, nullptr);
    EXPECT_NE(record.why.find("No such file"), std::string::npos) << record.why;
}

TEST(NoPlugin, FolderAndPipe) {
    const Scratch scratch;
    fs::create_directory(scratch.path("folder.so"));
    ASSERT_EQ(mkfifo(scratch.path("pipe.so").c_str(), 0600), 0);
    EXPECT_NE(clarity::load_plugin(scratch.path("folder.so")).why.find("folder"), std::string::npos);
    EXPECT_NE(clarity::load_plugin(scratch.path("pipe.so")).why.find("regular file"), std::string::npos);
}

TEST(NoPlugin, ThisVeryProgram) {
    const clarity::PluginRecord record = clarity::load_plugin("/proc/self/exe");
    EXPECT_EQ(record.plugin, nullptr);
    EXPECT_NE(record.why, "");
}

TEST(NoPlugin, OtherMachine) {
    const Scratch scratch;
    std::string bytes = read_file(library("sound"));
    ASSERT_GT(bytes.size(), 64u);
    std::string other = bytes;
    other[18] = 22;  // e_machine: S/390
    other[19] = 0;
    const clarity::PluginRecord record = clarity::load_plugin(scratch.write("other.so", other));
    EXPECT_EQ(record.plugin, nullptr);
    EXPECT_NE(record.why.find("library for S/390, this program runs on"), std::string::npos) << record.why;

    std::string narrow = bytes;
    narrow[4] = narrow[4] == 1 ? 2 : 1;  // EI_CLASS
    EXPECT_NE(clarity::load_plugin(scratch.write("narrow.so", narrow)).why.find("another kind of machine"), std::string::npos);
}

// However a library is truncated, it is refused, or it is loaded because only unused parts (section headers) are missing.
// How many bytes of a library are loaded: behind them are debug information and tables of sections.
size_t loaded_bytes(const std::string& library) {
    Elf64_Ehdr header;
    std::memcpy(&header, library.data(), sizeof header);
    uint64_t end = 0;
    for (size_t i = 0; i < header.e_phnum; ++i) {
        Elf64_Phdr segment;
        std::memcpy(&segment, &library[header.e_phoff + i * header.e_phentsize], sizeof segment);
        if (segment.p_type == PT_LOAD) end = std::max<uint64_t>(end, segment.p_offset + segment.p_filesz);
    }
    return end;
}

TEST(NoPlugin, TruncatedAnywhere) {
    const Scratch scratch;
    const std::string bytes = read_file(library("sound"));
    size_t refused = 0, truncated = 0;
    for (size_t size = 0; size < bytes.size(); size += 97) {
        clarity::ElfSymbol symbol;
        const std::string why =
            clarity::read_elf_symbol(scratch.write("cut.so", bytes.substr(0, size)), "rt_plugin_v1", symbol).text();
        refused += !why.empty();
        truncated += why.find("truncated") != std::string::npos;
    }
    EXPECT_GT(refused, 10u);
    EXPECT_GT(truncated, 10u);
    const clarity::PluginRecord half = clarity::load_plugin(scratch.write("half.so", bytes.substr(0, loaded_bytes(bytes) / 2)));
    EXPECT_EQ(half.plugin, nullptr);
    EXPECT_NE(half.why.find("truncated"), std::string::npos) << half.why;
}

// Reading damaged tables must give an answer, without a crash or an endless loop. Nothing is loaded here.
TEST(NoPlugin, DamagedTables) {
    const Scratch scratch;
    const std::string bytes = read_file(library("sound"));
    std::mt19937 random(1);
    size_t refused = 0;
    for (int round = 0; round < 3000; ++round) {
        std::string damaged = bytes;
        // The headers, the dynamic section and the hash tables are at both ends of the file; the code in the middle is not
        // read.
        const size_t changes = 1 + random() % 4;
        for (size_t i = 0; i < changes; ++i) {
            const size_t at = random() % 2 ? random() % 0x400 : random() % damaged.size();
            damaged[at] = static_cast<char>(random() % 3 == 0 ? 0xff : random());
        }
        clarity::ElfSymbol symbol;
        refused += clarity::read_elf_symbol(scratch.write("damaged.so", damaged), "rt_plugin_v1", symbol) || !symbol.found;
    }
    EXPECT_GT(refused, 100u);
}

// Flipped bits anywhere: the file is refused or sound, and this process goes on.
TEST(NoPlugin, FlippedBitsOfALibraryThatIsOpened) {
    const Scratch scratch;
    const std::string bytes = read_file(library("sound"));
    std::mt19937 random(2);
    size_t refused = 0, crashed = 0;
    for (int round = 0; round < 60; ++round) {
        std::string damaged = bytes;
        for (int i = 0; i < 64; ++i) damaged[random() % damaged.size()] ^= static_cast<char>(1u << (random() % 8));
        const auto record = clarity::load_plugin(scratch.write("flipped" + std::to_string(round) + ".so", damaged));
        refused += record.plugin == nullptr;
        crashed += record.why.find("the process that opened it") != std::string::npos;
    }
    EXPECT_GT(refused, 10u);
    RecordProperty("crashed", static_cast<int>(crashed));
}

}  // namespace

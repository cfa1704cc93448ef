#include "view/settings/settings.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "rt_types.h"
#include "view/settings/aov.hpp"

namespace clarity {
namespace {

// What all kinds have in common. The values are held in these members.
template <class... Member>
Setting row_of(const std::string& key, std::string label, std::string help, Effect effect, Member Settings::*... members) {
    Setting s;
    s.key = key;
    s.label = std::move(label);
    s.help = std::move(help);
    s.effect = effect;
    s.equal = [=](const Settings& a, const Settings& b) { return (... && (a.*members == b.*members)); };
    s.copy = [=](Settings& to, const Settings& from) { (..., (to.*members = from.*members)); };
    return s;
}

Setting with_range(Setting s, Setting::Kind kind, double min, double max) {
    s.kind = kind;
    s.min = min;
    s.max = max;
    return s;
}

// Gives a row its choices. `read` gets one of them.
template <class Read>
Setting with_choices(Setting s, const std::vector<std::string>& choices, Read read) {
    s.kind = Setting::Kind::choice;
    s.choices = choices;
    s.set = [key = s.key, choices, read](Settings& settings, const std::string& text) {
        const auto has = [&](const std::string& word) {
            return std::find(choices.begin(), choices.end(), word) != choices.end();
        };
        if (has(text)) return read(settings, text);
        // `true` and `false`, as from Python, are `on` and `off` where there are such choices.
        if (text == "true" && has("on")) return read(settings, "on");
        if (text == "false" && has("off")) return read(settings, "off");
        std::string known;
        for (const std::string& c : choices) known += (known.empty() ? "" : ", ") + c;
        refuse_value(key, text, "one of " + known);
    };
    return s;
}

// Gives a row of a number its text. A number that is not whole and goes from 0 to 1 is a share: 5% is 0.05.
template <class Number, class Read, class Write>
Setting with_number(Setting s, double min, double max, Read read, Write write) {
    constexpr bool kWhole = std::is_integral_v<Number>;
    s = with_range(std::move(s), kWhole ? Setting::Kind::integer : Setting::Kind::real, min, max);
    s.get = [read](const Settings& settings) { return exact_text(static_cast<double>(read(settings))); };
    s.set = [=, key = s.key](Settings& settings, const std::string& text) {
        Number value = 0;
        const bool is_share = !kWhole && min == 0 && max == 1;
        if (!(is_share ? read_share(text, value) : read_number(text, value)) || value < min || value > max)
            refuse_value(key, text,
                         (kWhole ? "a whole number from " : "a number from ") + exact_text(min) + " to " + exact_text(max) +
                             (is_share ? ", or from 0% to 100%" : ""));
        write(settings, value);
    };
    return s;
}

template <class Number>
Setting number(const std::string& key, std::string label, std::string help, double min, double max, Effect effect,
               Number Settings::* member) {
    return with_number<Number>(
        row_of(key, std::move(label), std::move(help), effect, member), min, max,
        [member](const Settings& settings) { return settings.*member; },
        [member](Settings& settings, Number value) { settings.*member = value; });
}

double stored(const Settings& settings, const std::string& key, double standard) {
    const auto found = settings.numbers.find(key);
    return found == settings.numbers.end() ? standard : found->second;
}

// A number that only kernels read: RT_SETTING(frame, key). This row is all that there is to it. The type of its default
// says whether it is a whole one.
template <class Number>
Setting kernel_number(const std::string& key, std::string label, std::string help, double min, double max, Number standard) {
    const auto read = [=](const Settings& settings) { return static_cast<Number>(stored(settings, key, standard)); };
    const auto write = [=](Settings& settings, Number value) {
        if (value == standard)
            settings.numbers.erase(key);
        else
            settings.numbers[key] = value;
    };
    Setting s = row_of(key, std::move(label), std::move(help), Effect::frame);
    s.equal = [=](const Settings& a, const Settings& b) { return read(a) == read(b); };
    s.copy = [=](Settings& to, const Settings& from) { write(to, read(from)); };
    s.number = standard;
    return with_number<Number>(std::move(s), min, max, read, write);
}

Setting boolean(const std::string& key, std::string label, std::string help, Effect effect, bool Settings::* member) {
    Setting s = with_range(row_of(key, std::move(label), std::move(help), effect, member), Setting::Kind::boolean, 0, 1);
    s.get = [member](const Settings& settings) { return std::string(settings.*member ? "true" : "false"); };
    s.set = [=](Settings& settings, const std::string& text) {
        if (text == "1" || text == "true" || text == "on" || text == "yes")
            settings.*member = true;
        else if (text == "0" || text == "false" || text == "off" || text == "no")
            settings.*member = false;
        else
            refuse_value(key, text, "true or false");
    };
    return s;
}

Setting choice(const std::string& key, std::string label, std::string help, const std::vector<std::string>& choices,
               Effect effect, std::string Settings::* member) {
    Setting s = with_choices(row_of(key, std::move(label), std::move(help), effect, member), choices,
                             [member](Settings& settings, const std::string& text) { settings.*member = text; });
    s.get = [member](const Settings& settings) { return settings.*member; };
    return s;
}

Setting size(const std::string& key, std::string label, std::string help, int min, int max, bool automatic, Effect effect,
             int Settings::* width, int Settings::* height) {
    Setting s =
        with_range(row_of(key, std::move(label), std::move(help), effect, width, height), Setting::Kind::size, min, max);
    s.get = [=](const Settings& settings) {
        if (automatic && settings.*width == 0) return std::string("auto");
        return std::to_string(settings.*width) + "x" + std::to_string(settings.*height);
    };
    s.set = [=](Settings& settings, const std::string& text) {
        if (automatic && text == "auto") {
            settings.*width = settings.*height = 0;
            return;
        }
        const size_t x = text.find('x');
        int w = 0, h = 0;
        if (x == std::string::npos || !read_number(text.substr(0, x), w) || !read_number(text.substr(x + 1), h) || w < min ||
            h < min || w > max || h > max)
            refuse_value(key, text, "WIDTHxHEIGHT, each from " + std::to_string(min) + " to " + std::to_string(max));
        settings.*width = w;
        settings.*height = h;
    };
    return s;
}

Setting lanes_setting() {
    Setting s =
        row_of("lanes", "Lanes", "rays that one work-item traces side by side; auto: 1 on a GPU, the float width of a CPU",
               Effect::recompile, &Settings::lanes);
    s = with_choices(std::move(s), {"auto", "1", "4", "8", "16"}, [](Settings& settings, const std::string& text) {
        settings.lanes = text == "auto" ? 0 : std::stoi(text);
    });
    s.get = [](const Settings& settings) { return settings.lanes == 0 ? std::string("auto") : std::to_string(settings.lanes); };
    return s;
}

}  // namespace

void check_pixel(const Settings& settings, unsigned x, unsigned y) {
    if (x >= static_cast<unsigned>(settings.width) || y >= static_cast<unsigned>(settings.height))
        throw Error(Exit::usage, "there is no pixel " + std::to_string(x) + "," + std::to_string(y) + " in a picture of " +
                                     std::to_string(settings.width) + "x" + std::to_string(settings.height));
}

bool has_light_tree(const Settings& settings) {
    return settings.light_sampling == "tree";
}

bool blurs(const Settings& settings) {
    return settings.shutter > 0 && settings.spp > 1 && find_aov(settings.aov).adds_samples();
}

bool denoises(const Settings& settings) {
    return settings.denoise == "on" && find_setting("denoise")->used(settings) && find_aov(settings.aov).is_color();
}

void refuse_value(const std::string& key, const std::string& value, const std::string& expected) {
    throw Error(Exit::usage, key + ": `" + value + "` is not " + expected);
}

std::vector<std::string> tone_names() {
    return {"linear", "reinhard", "aces", "agx"};
}

Setting Setting::in(SettingGroup of) const {
    Setting s = *this;
    s.group = of;
    return s;
}

Setting Setting::only_ways() const {
    Setting s = *this;
    s.changes_picture = false;
    return s;
}

Setting Setting::with_buttons(std::vector<Button> of) const {
    Setting s = *this;
    s.buttons = std::move(of);
    return s;
}

Setting Setting::only_of(const char* shown) const {
    Setting s = *this;
    s.picture = shown;
    return s;
}

bool Setting::used(const Settings& settings) const {
    return picture.empty() || picture == picture_of_tracer(settings.tracer);
}

namespace {

// Those of the tracer `path`.
std::vector<Setting> settings_of_paths() {
    std::vector<Setting> table = {
        choice("strategy", "Strategy",
               "how `path` finds light. nee: each event draws a point of a lamp; bsdf: rays that surfaces scatter find lamps "
               "and sky; mis: both, with weights. Lamps without a size are always drawn",
               {"nee", "bsdf", "mis"}, Effect::frame, &Settings::strategy),
        choice("mis", "Weights", "of the strategy mis: by densities (balance) or by their squares (power)",
               {"balance", "power"}, Effect::frame, &Settings::mis),
        choice(
            "sampler", "Sampler",
            "random numbers of `path`. independent: noise falls with the square root of the samples; sobol: numbers that are "
            "spread evenly over the samples of a pixel, with less noise",
            {"independent", "sobol"}, Effect::frame, &Settings::sampler),
        choice(
            "light_sampling", "Light pick",
            "how `path` picks the lamp or glowing surface that an event draws. table: by its power; tree: for the place too, "
            "by distance and direction, which costs more a pick and pays where lights are many and near",
            {"table", "tree"}, Effect::recompile, &Settings::light_sampling),
        kernel_number("seed", "Seed", "of `path`: pictures of two seeds have independent noise", 0, 1 << 30, 0),
        choice("filter", "Pixel filter",
               "of `path`. box: the points of a pixel count alike; gaussian: points near its middle count more, and those of "
               "its neighbours too (deviation half a pixel, cut at one and a half)",
               {"box", "gaussian"}, Effect::frame, &Settings::filter),
        kernel_number(
            "adaptive", "Adaptive",
            "of `path`: pixels rest once their standard error, estimated, is at most this share of their light (of the "
            "picture's mean light, where they are darker), so that samples go where noise is; 0: none rests. Pictures are "
            "then biased a little",
            0, 1, 0.0),
        kernel_number("only_bounce", "Only bounce",
                      "of `path`: light that came by so many events of scattering; 0: what the camera sees shine; -1: all", -1,
                      kMostDepth, -1)
            .with_buttons({{"-1", "all"}, {"0", "seen"}, {"1", "1"}, {"2", "2"}, {"3", "3"}}),
        choice("only_by", "Only by", "of `path`: light of points that were drawn on lamps (nee), or that rays found (bsdf)",
               {"any", "nee", "bsdf"}, Effect::frame, &Settings::only_by)
            .with_buttons({{"any", "all"}, {"nee", "drawn"}, {"bsdf", "found"}}),
        choice("only_first", "Only first",
               "of `path`: light whose last event before the camera was of this kind; mirrors are glossy",
               {"any", "diffuse", "glossy", "transmission"}, Effect::frame, &Settings::only_first)
            .with_buttons({{"any", "all"}, {"diffuse", "diffuse"}, {"glossy", "glossy"}, {"transmission", "through"}}),
        kernel_number("only_light", "Only light",
                      "of `path`: light of the lamp of this number, in the order of `info`; -1: all", -1, 1 << 20, -1),
    };
    for (Setting& row : table) row = row.in(SettingGroup::paths).only_of(kPathPicture);
    return table;
}

}  // namespace

const std::vector<Setting>& settings_table() {
    constexpr auto kTracing = SettingGroup::tracing, kPicture = SettingGroup::picture;
    static const std::vector<Setting> general = {
        choice("tracer", "Tracer", tracer_help(), tracer_names(), Effect::recompile, &Settings::tracer)
            .in(kTracing)
            .only_ways(),  // what a tracer's pictures show: TracerChoice::picture
        number(
            "depth", "Depth",
            "generations of rays, 1: camera rays only; of `path` the most events of scattering, each lit by lamps, and a last "
            "ray that may only find light",
            1, kMostDepth, Effect::frame, &Settings::depth)
            .in(kTracing),
        size("packet", "Packet",
             "pixels that one work-item computes; auto: 1x1 on a GPU; lanes x lanes, but at least 4x4, on a CPU", 1, 32, true,
             Effect::recompile, &Settings::packet_w, &Settings::packet_h)
            .in(kTracing)
            .only_ways(),
        lanes_setting().in(kTracing).only_ways(),
        number("ray_slots", "Ray slots", "rays that a pixel may have in one generation; more are dropped and counted", 1, 64,
               Effect::recompile, &Settings::ray_slots)
            .in(kTracing)
            .only_of(kWhittedPicture),
        boolean("shadows", "Shadows", "shadow rays to every light", Effect::frame, &Settings::shadows).in(kTracing),
        choice(
            "mips", "Smaller textures",
            "distant textures are shown by smaller copies of their pictures, which do not flicker. nearest: by one of them; "
            "smooth: by two, mixed, which loads twice as many texels; off: by the picture itself, which is noisy where it is "
            "far away; auto: smooth for `path`, else off, because even one costs a GPU 4 % of a frame",
            {"auto", "off", "nearest", "smooth"}, Effect::recompile, &Settings::mips)
            .in(kTracing),
        kernel_number("min_weight", "Least weight", "rays that would add less than this share are not followed", 0, 1,
                      1.0 / 512)
            .in(kTracing)
            .only_of(kWhittedPicture),
        choice("poses", "Each pose",
               "how the structure follows a scene that plays. refit: its boxes are fitted to what moved; build: a new tree; "
               "auto: refits until a build pays; clip: as auto, from the best of five trees. `render` builds each frame, and "
               "refits between the samples of a blurred one, unless this is build",
               {"auto", "refit", "build", "clip"}, Effect::rebuild, &Settings::poses)
            .in(kTracing)
            .only_ways(),
        size("size", "Size", "pixels of the picture", 1, 16384, false, Effect::frame, &Settings::width, &Settings::height)
            .in(kPicture),
        number("spp", "Samples", "samples a pixel", 1, 1 << 20, Effect::samples, &Settings::spp).in(kPicture),
        number(
            "shutter", "Shutter",
            "motion blur: the share of a frame's time that the shutter is open, half of it before the frame's time; 0: none. "
            "Each sample shows the scene at a time of its own, so take 16 samples or more. While the window plays, pictures "
            "are not blurred",
            0, 1, Effect::frame, &Settings::shutter)
            .in(kPicture),
        choice("aov", "Show", aov_help(), aov_names(), Effect::recompile, &Settings::aov).in(kPicture),
        number("scale_max", "Scale end", "value at the upper end of false colours; 0: the largest of the picture", 0, 1e9,
               Effect::display, &Settings::scale_max)
            .in(kPicture),
        number("exposure", "Exposure", "factor before tone mapping", 0, 1000, Effect::display, &Settings::exposure)
            .in(kPicture),
        choice("tone", "Tone mapping", "from linear light to the screen", tone_names(), Effect::display, &Settings::tone)
            .in(kPicture),
        choice("denoise", "Denoise",
               "of `path`: pictures are shown and written with their noise filtered away, which biases them. moving: while the "
               "view moves in the window, which `render` never does; on: always",
               {"off", "moving", "on"}, Effect::display, &Settings::denoise)
            .in(kPicture)
            .only_ways()  // a picture that is denoised has another digest all the same: picture_digest.cpp
            .only_of(kPathPicture),
        boolean("fast_math", "Fast maths", "lets the compiler ignore NaN and rounding rules; pictures may break",
                Effect::recompile, &Settings::fast_math),
        boolean("portable", "Portable code", "no CPU instructions beyond OpenCL C: for tests of the fallbacks",
                Effect::recompile, &Settings::portable)
            .only_ways(),
        boolean("debug", "Debug kernels", "bounds every traversal stack and counts what would overflow", Effect::recompile,
                &Settings::debug)
            .only_ways(),
        choice("trial", "Try kernels",
               "kernels that were edited, and those of plugins that did not come with the program, run in a worker process "
               "first, on a small scene; auto: on CPUs; off: never, for measurements",
               {"auto", "on", "off"}, Effect::recompile, &Settings::trial)
            .only_ways(),
    };
    static const std::vector<Setting> table = [] {
        std::vector<Setting> all = general;
        const auto first_of_picture =
            std::find_if(all.begin(), all.end(), [](const Setting& row) { return row.group == kPicture; });
        const std::vector<Setting> of_paths = settings_of_paths();
        all.insert(first_of_picture, of_paths.begin(), of_paths.end());
        return all;
    }();
    return table;
}

const std::vector<const Setting*>& kernel_numbers() {
    static const std::vector<const Setting*> numbers = [] {
        std::vector<const Setting*> found;
        for (const Setting& row : settings_table())
            if (row.number) found.push_back(&row);
        if (found.size() > RT_MOST_NUMBERS)
            throw Error(Exit::failed, "rt_frame has no room for " + std::to_string(found.size()) +
                                          " numbers of kernels: raise RT_MOST_NUMBERS in cl/rt_types.h");
        return found;
    }();
    return numbers;
}

uint32_t Setting::bits(const Settings& settings) const {
    const double value = stored(settings, key, *number);
    if (kind == Kind::integer) return static_cast<uint32_t>(static_cast<int32_t>(value));
    const float single = static_cast<float>(value);
    uint32_t bits = 0;
    std::memcpy(&bits, &single, sizeof bits);
    return bits;
}

double number_of(const Settings& settings, const std::string& key) {
    const Setting* const row = find_setting(key);
    if (!row || !row->number) throw Error(Exit::usage, "no number of kernels `" + key + "`");
    return stored(settings, key, *row->number);
}

const Setting* find_setting(const std::string& key) {
    for (const Setting& setting : settings_table())
        if (setting.key == key) return &setting;
    return nullptr;
}

void set_setting(Settings& settings, const std::string& key, const std::string& value) {
    if (const Setting* setting = find_setting(key)) {
        setting->set(settings, value);
        return;
    }
    std::string known;
    for (const Setting& setting : settings_table()) known += (known.empty() ? "" : ", ") + setting.key;
    throw Error(Exit::usage, "no setting `" + key + "`; there are " + known);
}

}  // namespace clarity

#include "base/numbers.hpp"
#include "tools/why/noise.hpp"

namespace clarity {
namespace {

void add_three(std::string& line, const rt_f32* v) {
    for (int k = 0; k < 3; ++k) line += "," + exact_text(v[k]);
}

// A name as a field: quotes around it, and doubled within it.
std::string quoted(const std::string& name) {
    std::string text = "\"";
    for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
    return text + "\"";
}

const char* kind_name(const rt_path_record& record) {
    static const char* const names[] = {"begins", "scatters", "lit"};
    return names[record.kind < 3 ? record.kind : 0];
}

std::string how_name(const rt_path_record& record) {
    if (record.kind == RT_PATH_BEGINS) return {};
    if (record.kind == RT_PATH_LIT) return record.how == RT_BY_NEE ? "nee" : "bsdf";
    return lobe_name(record.how) + std::string(record.flags & RT_PATH_SMOOTH ? " smooth" : "") +
           (record.flags & RT_PATH_ENDS ? " ends" : "");
}

}  // namespace

std::string paths_csv(const Replay& replay, const std::vector<unsigned>& samples, const NoiseNames& names, const Scene& scene) {
    std::string text =
        "sample,kind,bounce,x,y,z,beyond,how,light,material,weight_r,weight_g,weight_b,pdf,other_pdf,mis,light_r,light_g,light_"
        "b\n";
    for (const unsigned s : samples) {
        const ReplayedSample& sample = replay.samples[s];
        for (unsigned r = 0; r < sample.records; ++r) {
            const rt_path_record& record = replay.records[sample.first_record + r];
            const bool lit = record.kind == RT_PATH_LIT;
            std::string line = std::to_string(s) + "," + kind_name(record) + "," + std::to_string(record.bounce);
            add_three(line, record.at);
            line += std::string(",") + (record.flags & RT_PATH_BEYOND && lit ? "1" : "0") + "," + how_name(record) + ",";
            if (lit) line += quoted(light_title(names, record.light_number));
            line += ",";
            if (record.material >= 0 && size_t(record.material) < scene.materials.size())
                line += quoted(scene.materials[size_t(record.material)].name);
            add_three(line, record.weight);
            line += "," + exact_text(record.pdf) + "," + exact_text(record.other_pdf) + "," + exact_text(record.mis);
            add_three(line, record.light);
            text += line + "\n";
        }
    }
    return text;
}

}  // namespace clarity

#include "tools/check/builds/parameter_tries.hpp"

#include <cmath>

#include "base/numbers.hpp"
#include "stand/seed.hpp"

namespace clarity::check {

std::vector<ParameterValues> parameter_tries(const rt_plugin& plugin, uint64_t seed) {
    std::vector<ParameterValues> tries;
    if (plugin.param_count == 0) return tries;
    const ParameterValues usual = default_parameters(plugin);
    ParameterValues least = usual, most = usual;
    for (rt_u32 p = 0; p < plugin.param_count; ++p) {
        const rt_param& param = plugin.params[p];
        // Each choice may be code of its own; of numbers the ends.
        std::vector<double> values = {param.min, param.max};
        for (double choice = param.min + 1; param.kind == RT_PARAM_ENUM && choice < param.max; ++choice)
            values.push_back(choice);
        for (const double value : values) {
            if (value == param.def) continue;
            tries.push_back(usual);
            tries.back()[p] = value;
        }
        least[p] = param.min;
        most[p] = param.max;
    }
    tries.push_back(least);
    tries.push_back(most);
    std::mt19937 random = random_of(8, seed);
    for (int i = 0; i < 2; ++i) {
        ParameterValues between = usual;
        for (rt_u32 p = 0; p < plugin.param_count; ++p) {
            const rt_param& param = plugin.params[p];
            const double share = std::uniform_real_distribution<double>(0, 1)(random);
            between[p] = param.min + share * (param.max - param.min);
            if (param.kind != RT_PARAM_FLOAT) between[p] = std::round(between[p]);
        }
        tries.push_back(between);
    }
    return tries;
}

std::string choice_text(const rt_plugin& plugin, const ParameterValues& params) {
    std::string text = plugin.id;
    for (rt_u32 p = 0; p < plugin.param_count; ++p) {
        const rt_param& param = plugin.params[p];
        if (params[p] == param.def) continue;
        text += std::string(",") + param.key + "=" +
                (param.kind == RT_PARAM_ENUM ? param.choices[static_cast<size_t>(params[p])] : exact_text(params[p]));
    }
    return text;
}

}  // namespace clarity::check

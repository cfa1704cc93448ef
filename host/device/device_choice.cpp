// device_choice.cpp -- finds the devices that a user names.
#include <algorithm>
#include <cstdlib>
#include <functional>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/numbers.hpp"
#include "base/text.hpp"
#include "device/device_list.hpp"

namespace clarity {
namespace {

constexpr const char* kWords =
    "write numbers or P:D as `clarity devices` lists them, cpu, gpu, cpus, gpus, all or part of a name; commas between "
    "several, and cpu/2 for a CPU in two parts";

std::string table_of(const std::vector<DeviceInfo>& devices) {
    std::string text;
    for (size_t i = 0; i < devices.size(); ++i)
        text += (text.empty() ? "" : ", ") + std::to_string(i) + " = " + devices[i].id() + " " + devices[i].name +
                (devices[i].gpu   ? " (gpu)"
                 : devices[i].cpu ? " (cpu)"
                                  : "");
    return text;
}

constexpr const char* kPart = ", part ";  // between the name of a device and the number of its part

// Larger numbers of parts are mistakes.
constexpr unsigned kMostParts = 4096;

// A word of the user's choice. "cpu/2.1": device "cpu", 2 parts, part 1 (the second).
struct Word {
    std::string device;
    unsigned parts = 0;  // 0: the whole device
    int part = -1;       // -1: all parts
};

Word read_word(const std::string& text) {
    const size_t slash = text.rfind('/');
    if (slash == std::string::npos) return {text};
    const std::string tail = text.substr(slash + 1);
    if (tail.empty() || tail.find_first_not_of("0123456789.") != std::string::npos)
        return {text};  // the slash belongs to a name
    Word word{text.substr(0, slash)};
    const size_t dot = tail.find('.');
    unsigned part = 0;
    const bool good = read_number(tail.substr(0, dot), word.parts) && word.parts > 0 && word.parts <= kMostParts &&
                      (dot == std::string::npos || (read_number(tail.substr(dot + 1), part) && part < word.parts));
    if (!good)
        throw Error(Exit::no_device, "`" + text +
                                         "`: after the slash, write the number of parts, as in cpu/4, or also one of them, "
                                         "counted from 0, as in cpu/4.3");
    if (dot != std::string::npos) word.part = static_cast<int>(part);
    return word;
}

std::vector<DeviceInfo> named(const std::vector<DeviceInfo>& devices, const std::string& word) {
    const std::string wanted = lower(word);
    std::vector<DeviceInfo> found;
    const auto take = [&](const std::function<bool(const DeviceInfo&)>& fits, bool every) {
        for (const DeviceInfo& device : devices)
            if (fits(device) && (every || found.empty())) found.push_back(device);
    };
    unsigned number = 0;
    if (wanted == "all")
        return devices;
    else if (wanted == "cpu" || wanted == "cpus")
        take([](const DeviceInfo& device) { return device.cpu; }, wanted == "cpus");
    else if (wanted == "gpu" || wanted == "gpus")
        take([](const DeviceInfo& device) { return device.gpu; }, wanted == "gpus");
    else if (read_number(word, number) && number < devices.size())
        found = {devices[number]};
    else if (word.find_first_not_of("0123456789:") == std::string::npos)
        take([&](const DeviceInfo& device) { return device.id() == word; }, false);
    else
        take([&](const DeviceInfo& device) { return says(device.name, word) || says(device.platform, word); }, false);
    return found;
}

// Splits a device into `count` parts of nearly the same number of compute units.
std::vector<DeviceInfo> parts_of(const DeviceInfo& whole, unsigned count) {
    const auto cannot = [&](const std::string& why) {
        return Error(Exit::no_device,
                     whole.id() + " (" + whole.name + ") cannot be split into " + std::to_string(count) + " parts: " + why);
    };
    if (count == 1) return {whole};
    if (count > whole.compute_units)
        throw cannot("it has " + std::to_string(whole.compute_units) + " compute units, and a part needs one");
    std::vector<DeviceInfo> parts;
    try {
        const auto kinds = whole.cl_device.getInfo<CL_DEVICE_PARTITION_PROPERTIES>();
        const auto can = [&](cl_device_partition_property kind) {
            return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
        };
        std::vector<cl_device_partition_property> how;
        if (whole.compute_units % count == 0 && can(CL_DEVICE_PARTITION_EQUALLY)) {
            how = {CL_DEVICE_PARTITION_EQUALLY, cl_device_partition_property(whole.compute_units / count), 0};
        } else if (can(CL_DEVICE_PARTITION_BY_COUNTS)) {
            how = {CL_DEVICE_PARTITION_BY_COUNTS};
            for (unsigned i = 0; i < count; ++i)
                how.push_back(whole.compute_units * (i + 1) / count - whole.compute_units * i / count);
            how.insert(how.end(), {CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0});
        } else {
            throw cannot("its driver does not support this; CPUs can be split, most GPUs cannot");
        }
        std::vector<cl::Device> handles;
        cl::Device(whole.cl_device).createSubDevices(how.data(), &handles);
        for (unsigned i = 0; i < handles.size(); ++i) {
            DeviceInfo part = whole;
            part.part = i;
            part.parts = count;
            part.name += kPart + std::to_string(i + 1) + " of " + std::to_string(count);
            part.compute_units = handles[i].getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
            part.cl_device = handles[i];
            parts.push_back(std::move(part));
        }
    } catch (const cl::Error& e) {
        throw cannot(std::string(e.what()) + " answers with OpenCL error " + std::to_string(e.err()));
    }
    return parts;
}

void add_word(const std::vector<DeviceInfo>& devices, const std::string& text, std::vector<DeviceInfo>& chosen) {
    const Word word = read_word(text);
    const std::vector<DeviceInfo> wholes = named(devices, word.device);
    if (wholes.empty())
        throw Error(Exit::no_device, "`" + word.device + "`: no such device; there are " + table_of(devices) + "; " + kWords);
    for (const DeviceInfo& whole : wholes) {
        std::vector<DeviceInfo> found = word.parts > 0 ? parts_of(whole, word.parts) : std::vector<DeviceInfo>{whole};
        if (word.part >= 0) found = {found.at(static_cast<size_t>(word.part))};
        for (DeviceInfo& info : found) {
            const auto same = [&](const DeviceInfo& other) { return other.id() == info.id(); };
            if (std::none_of(chosen.begin(), chosen.end(), same)) chosen.push_back(std::move(info));
        }
    }
}

}  // namespace

std::string DeviceInfo::name_of_whole() const {
    return parts > 0 ? name.substr(0, name.rfind(kPart)) : name;
}

std::string DeviceInfo::id() const {
    const std::string whole = std::to_string(platform_index) + ":" + std::to_string(device_index);
    return parts > 1 ? whole + "/" + std::to_string(parts) + "." + std::to_string(part) : whole;
}

std::vector<DeviceInfo> choose_devices(const std::string& choice) {
    std::vector<DeviceWarning> warnings;
    const std::vector<DeviceInfo> devices = list_devices(&warnings);
    const char* variable = std::getenv("CLARITY_DEVICE");
    const std::string wanted = choice.empty() && variable ? variable : choice;
    if (devices.empty()) {
        std::string why;
        for (const DeviceWarning& warning : warnings) why += "; " + warning.text;
        if (why.find(kInstallDriver) == std::string::npos) why += std::string("; ") + kInstallDriver;
        throw Error(Exit::no_device, "no OpenCL device" + why);
    }
    log_warnings(warnings);
    if (wanted.empty()) return {devices.front()};
    std::vector<DeviceInfo> chosen;
    try {
        for (size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
            end = wanted.find(',', begin);
            add_word(devices, wanted.substr(begin, end == std::string::npos ? end : end - begin), chosen);
        }
    } catch (const Error& e) {
        throw Error(e.code(), (choice.empty() ? "CLARITY_DEVICE=" : "--device ") + wanted + ": " + e.what());
    }
    return chosen;
}

DeviceInfo choose_device(const std::string& choice) {
    return choose_devices(choice).front();
}

std::string device_list_text(const std::vector<DeviceInfo>& devices) {
    std::string text;
    for (const DeviceInfo& device : devices) text += (text.empty() ? "" : ",") + device.id();
    return text;
}

}  // namespace clarity

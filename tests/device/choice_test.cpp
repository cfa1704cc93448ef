// choice_test.cpp -- the words that name devices.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "device/device.hpp"

using namespace clarity;

namespace {

class DeviceChoice : public ::testing::Test {
 protected:
    void SetUp() override {
        all_ = list_devices();
        if (all_.empty()) GTEST_SKIP() << "no OpenCL device on this machine";
    }
    static std::string ids(const std::string& choice) { return device_list_text(choose_devices(choice)); }
    static std::string refusal(const std::string& choice) {
        try {
            return "chose " + ids(choice);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), Exit::no_device) << choice;
            return e.what();
        }
    }
    std::vector<DeviceInfo> all_;
};

}  // namespace

TEST_F(DeviceChoice, FindsOneByNumberIdKindAndName) {
    for (size_t i = 0; i < all_.size(); ++i) {
        EXPECT_EQ(ids(std::to_string(i)), all_[i].id());
        EXPECT_EQ(ids(all_[i].id()), all_[i].id());
    }
    EXPECT_EQ(ids(all_[0].name.substr(1, 6)), all_[0].id());
    EXPECT_EQ(ids(all_[0].gpu ? "GPU" : "CPU"), all_[0].id());
}

TEST_F(DeviceChoice, FindsSeveralEachOnce) {
    EXPECT_EQ(ids("all"), device_list_text(all_));
    EXPECT_EQ(ids("0,0," + all_[0].id()), all_[0].id());
    EXPECT_EQ(ids("0,all"), device_list_text(all_));
    size_t cpus = 0;
    for (const DeviceInfo& device : all_) cpus += device.cpu;
    if (cpus > 0) {
        EXPECT_EQ(choose_devices("cpus").size(), cpus);
    }
}

TEST_F(DeviceChoice, DividesACpuIntoParts) {
    DeviceInfo cpu;
    for (const DeviceInfo& device : all_)
        if (device.cpu && cpu.name.empty()) cpu = device;
    if (cpu.compute_units < 2) GTEST_SKIP() << "NOT TESTED: no CPU with two compute units";
    const std::vector<DeviceInfo> parts = choose_devices("cpu/2");
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[0].id(), cpu.id() + "/2.0");
    EXPECT_EQ(parts[1].id(), cpu.id() + "/2.1");
    EXPECT_NE(parts[0].name, parts[1].name) << "names tell the parts apart";
    EXPECT_EQ(parts[0].compute_units + parts[1].compute_units, cpu.compute_units);
    EXPECT_EQ(ids(parts[1].id()), parts[1].id()) << "a printed id can be used as a choice";
    EXPECT_EQ(ids(device_list_text(parts)), device_list_text(parts));
    EXPECT_EQ(ids("cpu/1"), cpu.id());
    EXPECT_NE(refusal("cpu/4000").find("compute units"), std::string::npos) << refusal("cpu/4000");
}

TEST_F(DeviceChoice, AnUnknownDeviceIsAnErrorThatListsTheDevices) {
    for (const char* wrong : {"9:9", "0:", "999", "no such device", "0,99", "", "0,,0", ",", "0,no such device"}) {
        if (!*wrong) continue;  // an empty choice means the best device
        const std::string why = refusal(wrong);
        EXPECT_NE(why.find(all_[0].id()), std::string::npos) << wrong << ": " << why;
        EXPECT_EQ(why.find(std::string("--device ") + wrong), 0u) << why;
    }
    for (const char* odd : {"cpu/0", "cpu/", "cpu/2.2", "cpu/2.", "cpu/99999999999", "cpu/.1"})
        EXPECT_NE(refusal(odd).find("`cpu/"), std::string::npos) << odd << ": " << refusal(odd);
}

// Lists of members: counted, copied, compared. That one with a gap does not compile is the test `members_forgotten`.
#include "base/members.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace clarity {
namespace {

struct Base {
    float x = 0;
};
struct Derived : Base {
    std::array<float, 3> y{};
    double z = 1;
};
struct Many {
    std::string text;
    std::vector<bool> flags;
    std::map<int, std::string> map;
    std::optional<std::string> maybe;
    std::function<void()> call;
    std::unique_ptr<int> owned;
    const int* pointer = nullptr;
    bool flag = false;
};
static_assert(has_member_count<Base, 1> && has_member_count<Derived, 3> && has_member_count<Many, 8>);
static_assert(!has_member_count<Many, 7> && !has_member_count<Many, 9>);

struct Row {
    std::string name;
    int number = 0;
    std::vector<double> more;
    CLARITY_MEMBERS(name, number, more);
};
static_assert(has_members<Row> && has_members<const Row> && !has_members<Many>);

TEST(Members, CompareAndCopy) {
    const Row a{"a", 1, {2, 3}};
    Row b{"b", 1, {2, 3}};
    EXPECT_NE(members_of(a), members_of(b));
    members_of(b) = members_of(a);
    EXPECT_EQ(members_of(a), members_of(b));
    b.more.clear();
    EXPECT_NE(members_of(a), members_of(b));
    int count = 0;
    for_each_member(a, [&](const auto&) { ++count; });
    EXPECT_EQ(count, 3);
}

}  // namespace
}  // namespace clarity

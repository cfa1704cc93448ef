// Must not compile: the list lacks a member.
#include "base/members.hpp"

struct Part {
    int listed = 0, forgotten = 0;
    CLARITY_MEMBERS(listed);
};
bool same(const Part& a, const Part& b) {
    return clarity::members_of(a) == clarity::members_of(b);
}

// members.hpp -- structs that list their members once, for all that writes, reads, compares or copies them:
//     CLARITY_MEMBERS(name, numbers);
// It names all members in their order. While it lacks one, what goes through members_of() does not compile.
#pragma once
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#define CLARITY_MEMBERS(...)          \
    template <class Self>             \
    static auto members(Self& self) { \
        auto& [__VA_ARGS__] = self;   \
        return std::tie(__VA_ARGS__); \
    }                                 \
    static_assert(true, "for a semicolon")

namespace clarity {
namespace detail {

struct AnyMember {
    template <class T>
    operator T() const;
};
template <size_t>
using AnyMemberOf = AnyMember;

template <class T, class Indices, class = void>
inline constexpr bool takes = false;
template <class T, size_t... I>
inline constexpr bool takes<T, std::index_sequence<I...>, std::void_t<decltype(T{AnyMemberOf<I>{}...})>> = true;

template <class T, class = void>
inline constexpr bool has_list = false;
template <class T>
inline constexpr bool has_list<T, std::void_t<decltype(T::members(std::declval<T&>()))>> = true;

}  // namespace detail

template <class T>
inline constexpr bool has_members = detail::has_list<std::remove_const_t<T>>;

// Whether an aggregate has that many members. A base counts as one, and each element of an array in C's manner as one.
template <class T, size_t count>
inline constexpr bool has_member_count =
    detail::takes<T, std::make_index_sequence<count>> && !detail::takes<T, std::make_index_sequence<count + 1>>;

// References to all members, in the order of the list. Tuples compare and copy them.
template <class T>
auto members_of(T& self) {
    using Struct = std::remove_const_t<T>;
    using Tuple = decltype(Struct::members(self));
    static_assert(has_member_count<Struct, std::tuple_size_v<Tuple>>, "members() has to list each member of the struct once");
    return Struct::members(self);
}

template <class T, class Body>
void for_each_member(T& self, Body&& body) {
    std::apply([&](auto&... member) { (body(member), ...); }, members_of(self));
}

}  // namespace clarity

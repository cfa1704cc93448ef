// parcel.hpp -- values in a file in memory, by which the processes of a host give them to each other.
//
// Values stand one behind the other, without their names: writer and reader visit them in the same order. Plain data is
// its bytes; a text is the number of its bytes (8 bytes) and its bytes; other containers are the number of their elements and
// these. An array of plain data is the number of its bytes, and these at the next multiple of kAlignment; it is padded to such
// a multiple. So the large arrays of a file may be used where they lie.
//
// A struct goes by its list of members (base/members.hpp). One that is written in another way has
//     template <class Parcel, class Self> static void visit(Parcel& parcel, Self& self) { parcel(self.name, self.numbers); }
#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/memory_file.hpp"
#include "base/members.hpp"

namespace clarity {

// A file that holds something else than what is read, or was cut.
struct ParcelDamaged : Error {
    ParcelDamaged() : Error(Exit::failed, "the shared memory is damaged") {}
};

namespace detail {

template <class T, class Parcel, class = void>
inline constexpr bool is_visited = false;
template <class T, class Parcel>
inline constexpr bool is_visited<T, Parcel, std::void_t<decltype(T::visit(std::declval<Parcel&>(), std::declval<T&>()))>> =
    true;

// Of plain elements that lie one behind the other.
template <class T, class = void>
inline constexpr bool is_array = false;
template <class T>
inline constexpr bool is_array<T, std::void_t<decltype(std::declval<const T&>().data()), typename T::value_type>> =
    std::is_trivially_copyable_v<typename T::value_type>;

// A SharedArray: its elements may lie in memory of another owner.
template <class T, class = void>
inline constexpr bool is_shared = false;
template <class T>
inline constexpr bool is_shared<T, std::void_t<decltype(std::declval<T&>().own())>> = true;

// What may be filled in of a container's elements.
template <class T, class = void>
struct Element {
    using type = typename T::value_type;
};
template <class T>
struct Element<T, std::void_t<typename T::mapped_type>> {
    using type = std::pair<typename T::key_type, typename T::mapped_type>;
};

template <class T>
inline constexpr bool is_pair = false;
template <class A, class B>
inline constexpr bool is_pair<std::pair<A, B>> = true;

// Asks for large pages where an array spans some, because half of the reading time is spent on page faults.
void advise_large_pages(void* data, uint64_t bytes);

}  // namespace detail

inline constexpr uint64_t kParcelAlignment = 128;

// Writes into an empty file. All functions throw Error(failed).
class ParcelWriter {
 public:
    static constexpr bool kWrites = true;
    explicit ParcelWriter(MemoryFile& file) : file_(file) {}
    template <class... Values>
    void operator()(Values&&... values) {
        (put(values), ...);
    }
    // An array. gives_back: its memory goes back to the system behind the writing, and its elements are lost.
    void bytes(const void* data, uint64_t count, bool gives_back = false);
    // Writes what is left. Afterwards the file keeps its size.
    void finish();

 private:
    template <class T>
    void put(T& value) {
        using Value = std::remove_const_t<T>;
        if constexpr (detail::is_visited<Value, ParcelWriter>) {
            Value::visit(*this, value);
        } else if constexpr (has_members<Value>) {
            for_each_member(value, [&](auto& member) { put(member); });
        } else if constexpr (detail::is_pair<Value>) {
            put(value.first), put(value.second);
        } else if constexpr (std::is_same_v<Value, std::string>) {
            plain(uint64_t{value.size()});
            append(value.data(), value.size());
        } else if constexpr (std::is_trivially_copyable_v<Value>) {
            plain(value);
        } else if constexpr (detail::is_array<Value>) {
            bytes(value.data(), value.size() * sizeof(typename Value::value_type));
        } else {
            plain(uint64_t{value.size()});
            const Value& elements = value;
            for (const auto& element : elements) put(element);
        }
    }
    template <class T>
    void plain(const T& value) {
        static_assert(!std::is_pointer_v<T>, "addresses mean nothing in another process");
        append(&value, sizeof value);
    }
    void append(const void* data, uint64_t count);
    void pad();
    void flush();

    MemoryFile& file_;
    uint64_t at_ = 0;      // bytes of the file that are written
    std::string waiting_;  // what follows them
};

// Reads what a ParcelWriter wrote. The other process is not trusted. Every size is compared with that of the file, which must
// be sealed. Each byte is read once, because that process may still write. Functions throw ParcelDamaged, and Error(failed) if
// the file cannot be read.
class ParcelReader {
 public:
    static constexpr bool kWrites = false;
    enum class How {
        copied,   // the file stays as it is
        emptied,  // the file's memory goes back to the system behind the reading, so that large arrays are not held twice
        mapped    // a SharedArray refers to the file's memory. Only for a file that is sealed whole
    };
    ParcelReader(const MemoryFile& file, How how);
    template <class... Values>
    void operator()(Values&... values) {
        (get(values), ...);
    }
    // The bytes of an array that comes next, and its content: all of it must be taken.
    uint64_t begin_array();
    void take(void* to, uint64_t count) { read(to, count, false), end_array(); }
    // Of a file that is mapped: the content where it lies. It lives as long as memory().
    const char* borrow(uint64_t count);
    const std::shared_ptr<const char>& memory() const { return memory_; }
    // Throws unless everything has been read.
    void end() const;

 private:
    template <class T>
    void get(T& value) {
        if constexpr (detail::is_visited<T, ParcelReader>) {
            T::visit(*this, value);
        } else if constexpr (has_members<T>) {
            for_each_member(value, [&](auto& member) { get(member); });
        } else if constexpr (std::is_same_v<T, bool>) {
            char byte = 0;  // that may be no bool
            read(&byte, 1, false);
            value = byte != 0;
        } else if constexpr (detail::is_pair<T>) {
            get(value.first), get(value.second);
        } else if constexpr (std::is_same_v<T, std::string>) {
            value.resize(checked(number()));
            read(value.data(), value.size(), false);
        } else if constexpr (std::is_trivially_copyable_v<T>) {
            read(&value, sizeof value, false);
        } else if constexpr (detail::is_array<T>) {
            get_array(value);
        } else {
            value = T();
            for (uint64_t left = number(); left > 0; --left) {
                typename detail::Element<T>::type element{};
                get(element);
                value.insert(value.end(), std::move(element));
            }
        }
    }
    template <class Array>
    void get_array(Array& array) {
        using Value = typename Array::value_type;
        const uint64_t count = begin_array();
        if (count % sizeof(Value) != 0) throw ParcelDamaged();
        if constexpr (detail::is_shared<Array>) {
            if (memory_)
                array = Array::borrow(memory_, reinterpret_cast<const Value*>(borrow(count)), count / sizeof(Value));
            else
                copy_array(array.own(), count / sizeof(Value));
        } else {
            copy_array(array, count / sizeof(Value));
        }
    }
    template <class Vector>
    void copy_array(Vector& array, uint64_t count) {
        using Value = typename Vector::value_type;
        array.clear();
        array.reserve(count);
        detail::advise_large_pages(array.data(), count * sizeof(Value));
        // Pieces that stay in the processor's cache until they are in their array.
        const uint64_t most = std::max<uint64_t>(1, (uint64_t(256) << 10) / sizeof(Value));
        std::vector<Value> piece(std::min(most, count));
        for (uint64_t done = 0; done < count;) {
            const uint64_t now = std::min<uint64_t>(piece.size(), count - done);
            read(piece.data(), now * sizeof(Value), true);
            array.insert(array.end(), piece.data(), piece.data() + now);
            done += now;
        }
        end_array();
    }
    uint64_t number() {
        uint64_t value = 0;
        read(&value, sizeof value, false);
        return value;
    }
    // Returns a number of bytes if so many are left.
    uint64_t checked(uint64_t count) const;
    void read(void* to, uint64_t count, bool of_array);
    void skip_padding();
    void end_array();

    const MemoryFile& file_;
    const How how_;
    std::shared_ptr<const char> memory_;
    uint64_t bytes_, at_ = 0, given_back_ = 0;
    std::vector<char> ahead_;  // of a file that is not mapped: what lies from ahead_at_ on, so that not each number is a call
    uint64_t ahead_at_ = 0;    // of the system
};

}  // namespace clarity

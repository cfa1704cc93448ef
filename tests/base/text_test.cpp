// Text from files and libraries cannot move the cursor, set the title or hide anything.
#include "base/text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "base/digest.hpp"
#include "base/half.hpp"

using clarity::Digest;
using clarity::digest_of;
using clarity::printable;
using clarity::printable_line;

TEST(Printable, ShowsControlCharacters) {
    EXPECT_EQ(printable("\x1b[2J\x1b]0;title\x07"), "\\x1b[2J\\x1b]0;title\\x07");
    EXPECT_EQ(printable(std::string_view("a\0b\r\x7f", 5)), "a\\x00b\\x0d\\x7f");
    EXPECT_EQ(printable("two\nlines\tand a tab"), "two\nlines\tand a tab");
    EXPECT_EQ(printable_line("two\nlines\tand a tab"), "two\\x0alines\\x09and a tab");
}

TEST(Printable, KeepsValidUtf8AndShowsTheRest) {
    EXPECT_EQ(printable("B\xc3\xa4r \xe2\x82\xac \xf0\x9f\x98\x80"), "B\xc3\xa4r \xe2\x82\xac \xf0\x9f\x98\x80");
    EXPECT_EQ(printable("\xc2\x9b[2J"), "\\xc2\\x9b[2J") << "C1: terminals take it for the start of a sequence";
    EXPECT_EQ(printable("\x9b[2J"), "\\x9b[2J") << "the same as one byte";
    EXPECT_EQ(printable("\xc2\xa0"), "\xc2\xa0") << "a space that does not break";
    EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b") << "overlong";
    EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half of a surrogate pair";
    EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82") << "cut short";
    EXPECT_EQ(printable("\xff"), "\\xff");
}

TEST(Printable, PrintTextFormatsLikePrintf) {
    testing::internal::CaptureStdout();
    clarity::print_text("%s %d\n", "\x1b[31m", 5);
    clarity::print_text("%s", "");
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "\\x1b[31m 5\n");
}

// The values are those of the program `xxh128sum`: digests in records must mean the same for ever.
TEST(Digest, IsThatOfXxHash) {
    EXPECT_EQ(digest_of(""), "99aa06d3014798d86001c324468d497f");
    EXPECT_EQ(digest_of("clarity"), "be20150ada9c62997ffdcb40eea10612");
}

TEST(Digest, DoesNotDependOnPieces) {
    std::string text;
    for (int i = 0; i < 5000; ++i) text += static_cast<char>('a' + i * i % 23);
    for (const size_t piece : {1u, 7u, 240u, 1024u}) {
        Digest digest;
        for (size_t at = 0; at < text.size(); at += piece) digest.add_bytes(&text[at], std::min(piece, text.size() - at));
        EXPECT_EQ(digest.hex(), digest_of(text)) << piece;
    }
}

TEST(Digest, TextsKeepTheirEnds) {
    Digest a, b;
    a.add("ab"), a.add("c");
    b.add("a"), b.add("bc");
    EXPECT_NE(a.hex(), b.hex());
}

// Numbers of 16 bits.

namespace clarity::test {
namespace {

double value_of(unsigned bits) {
    const int exponent = static_cast<int>(bits >> 10), digits = static_cast<int>(bits & 1023);
    return exponent == 0 ? std::ldexp(digits, -24) : std::ldexp(digits + 1024, exponent - 25);
}

// Each half is its own; what lies between two becomes the nearer one, and the middle the even one.
TEST(Half, IsTheNearest) {
    for (unsigned bits = 0; bits < 0x7bff; ++bits) {
        const double here = value_of(bits), next = value_of(bits + 1), middle = (here + next) / 2;
        ASSERT_EQ(to_half(static_cast<float>(here)), bits);
        ASSERT_EQ(to_half(static_cast<float>(middle)), bits + (bits & 1)) << bits;
        ASSERT_EQ(to_half(std::nextafter(static_cast<float>(middle), 0.0f)), bits) << bits;
        ASSERT_EQ(to_half(std::nextafter(static_cast<float>(middle), 1e9f)), bits + 1) << bits;
    }
    EXPECT_EQ(value_of(0x7bff), kLargestHalf);
    EXPECT_EQ(to_half(kLargestHalf), 0x7bff);
    EXPECT_EQ(to_half(1e30f), 0x7bff);
}

}  // namespace
}  // namespace clarity::test

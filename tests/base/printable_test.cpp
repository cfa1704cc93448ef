// Text from files and libraries cannot move the cursor, set the title or hide anything.
#include "base/printable.hpp"

#include <gtest/gtest.h>

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

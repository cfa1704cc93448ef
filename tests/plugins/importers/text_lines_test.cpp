// text_lines_test.cpp -- lines of texts from all kinds of programs.
#include "../../../plugins/importers/common/text_lines.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace importers {
namespace {

using Texts = std::vector<std::string>;

Texts lines_of(std::string_view text) {
    Texts out;
    Lines lines(text);
    for (std::string_view line; lines.next(line);) out.emplace_back(line);
    EXPECT_EQ(lines.number(), out.size());
    EXPECT_EQ(lines.fraction(), 1);
    return out;
}

TEST(TextLines, EndWithLfCrLfOrCr) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        for (const std::string mark : {"", "\xEF\xBB\xBF"}) {
            EXPECT_EQ(lines_of(mark + "a" + end + end + "b c" + end), (Texts{"a", "", "b c"}));
            EXPECT_EQ(lines_of(mark + "a" + end + "b"), (Texts{"a", "b"}));
        }
    }
    EXPECT_EQ(lines_of("a\rb\nc\r\nd\n\re"), (Texts{"a", "b", "c", "d", "", "e"}));
    EXPECT_EQ(lines_of("\r"), Texts{""});
    EXPECT_EQ(lines_of(""), Texts{});
    EXPECT_EQ(lines_of("\xEF\xBB\xBF"), Texts{});
    // Only the first three bytes are a mark.
    EXPECT_EQ(lines_of("a\n\xEF\xBB\xBF"), (Texts{"a", "\xEF\xBB\xBF"}));
}

TEST(TextLines, GoOnBehindABackslash) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        const std::string text = "f 1 2\\" + end + "3\\" + end + "4" + end + "v\\";
        Lines lines(text);
        std::string_view line;
        ASSERT_TRUE(lines.next_joined(line));
        EXPECT_EQ(line, "f 1 2 3 4");
        EXPECT_EQ(lines.number(), 3u);
        ASSERT_TRUE(lines.next_joined(line));
        EXPECT_EQ(line, "v ");
        EXPECT_FALSE(lines.next_joined(line));
    }
}

TEST(TextLines, LeaveBinaryDataWhole) {
    const auto data_behind = [](const std::string& text) {
        Lines lines(text);
        for (std::string_view line; lines.next(line) && line != "end";) {
        }
        return std::string(lines.data());
    };
    EXPECT_EQ(data_behind("ply\nend\n\n\r"), "\n\r");
    EXPECT_EQ(data_behind("ply\r\nend\r\n\n\r"), "\n\r");
    EXPECT_EQ(data_behind("ply\rend\r\n\r"), "\n\r");  // the first byte of the data is a LF
    EXPECT_EQ(data_behind("ply\rend\rx"), "x");
    EXPECT_EQ(data_behind("ply\nend\n"), "");
}

}  // namespace
}  // namespace importers

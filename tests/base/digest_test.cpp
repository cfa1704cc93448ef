#include "base/digest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

using clarity::Digest;
using clarity::digest_of;

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

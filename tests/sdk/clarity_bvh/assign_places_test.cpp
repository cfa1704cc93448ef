// assign_places_test.cpp -- compares the assignment of children to slots with a search through all pairs, for each instruction
// set.
#include <gtest/gtest.h>

#include <random>

#include "clarity_bvh/kernels/kernels.hpp"

using namespace clarity::bvh;

namespace {

// Returns the number with the tag of a pair in its lowest bits.
float tagged(float value, uint32_t tag) {
    uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    bits = (bits & ~(kTags - 1)) | tag;
    std::memcpy(&value, &bits, sizeof bits);
    return value;
}

}  // namespace

TEST(AssignPlaces, AssignsTheBestPairFirst) {
    std::mt19937 random(7);
    for (int turn = 0; turn < 3000; ++turn) {
        const uint32_t count = 1 + turn % kPlaces;
        Suits suits[kPlaces];
        for (uint32_t i = 0; i < count; ++i)
            for (uint32_t p = 0; p < kPlaces; ++p)
                suits[i].place[p] = tagged(static_cast<float>(static_cast<int>(random() % 20) - 10) + 0.5f, kPlaces * i + p);
        uint32_t expected[kPlaces] = {};
        bool gone[kPlaces] = {}, taken[kPlaces] = {};
        for (uint32_t left = count; left > 0; --left) {
            uint32_t thing = kPlaces, place = 0;
            for (uint32_t i = 0; i < count; ++i)
                for (uint32_t p = 0; p < kPlaces; ++p)
                    if (!gone[i] && !taken[p] && (thing == kPlaces || suits[i].place[p] > suits[thing].place[place])) {
                        thing = i;
                        place = p;
                    }
            expected[thing] = place;
            gone[thing] = taken[place] = true;
        }
        for (const Kernels* k : {&kernels(), &generic::kernels}) {
            Suits own[kPlaces];
            std::copy_n(suits, count, own);
            uint32_t place_of[kPlaces] = {};
            k->assign_places(own, count, place_of);
            for (uint32_t i = 0; i < count; ++i) ASSERT_EQ(place_of[i], expected[i]) << "thing " << i << " of " << count;
        }
    }
}

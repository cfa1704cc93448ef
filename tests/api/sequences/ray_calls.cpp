// ray_calls.cpp -- calls that trace rays, at once, packed, or with hits that are kept.
#include <algorithm>
#include <cmath>

#include "arguments.hpp"
#include "call_lists.hpp"

namespace sequences {
namespace {

// Of large sets some rays are compared, always the first and the last.
template <class Compare>
std::string compared(const std::vector<std::shared_ptr<const World>>& worlds, size_t count, const Compare& compare) {
    std::string why;
    const size_t step = count > 400 ? count / 97 : 1;
    for (const auto& world : worlds) {
        why.clear();
        for (size_t i = 0; i < count && why.empty(); i = i + step < count || i + 1 == count ? i + step : count - 1)
            why = compare(*world, i);
        if (why.empty()) return "";
    }
    return why;  // of the last one, where the scene is now
}

// Rays for one call, in arrays or packed, and one mistake or none.
class Query {
 public:
    enum class May { all, hits };  // hits: packed rays serve too
    // count: of rays in arrays; null: any.
    Query(Step& step, Tracer* tracer, May may, const size_t* count = nullptr)
        : packed_(!count && step.draw.chance(0.25) ? step.state.packed.any(step.draw) : nullptr),
          packed_elsewhere_(packed_ && (may == May::all || packed_->tracer.lock().get() != tracer)),
          wrong_(tracer && !packed_elsewhere_ && step.draw.chance(0.15)),
          watch_(step.draw, tracer && !packed_elsewhere_ && !wrong_) {
        Draw& draw = step.draw;
        static const World nowhere;
        std::shared_ptr<const World> world;
        if (tracer) {
            const std::lock_guard<std::mutex> lock(tracer->lock);
            world = tracer->worlds.back();
        }
        const double far = tracer ? tracer->scene->far : 0;
        if (packed_) {
            clarity_rays rays{};
            rays.count = packed_->rays.size();
            rays.packed = packed_->handle;
            // No array is read of packed rays.
            rays.origins = reinterpret_cast<const void*>(8);
            rays.type = draw.one_of({CLARITY_FLOAT32, CLARITY_FLOAT64});
            given_ = Struct<clarity_rays>(draw, rays);
            if (packed_elsewhere_) expect(CLARITY_USAGE, "packed");
        } else {
            // Few rays many times.
            arrays_ = std::make_unique<RayArrays>(draw, world ? *world : nowhere, far, count ? *count : some_count(draw));
            given_ = Struct<clarity_rays>(draw, arrays_->given);
            if (draw.chance(0.1)) {  // of the first release
                const uint32_t bytes = offsetof(clarity_rays, mask);
                Bytes shorter(bytes);
                std::memcpy(shorter.as<char>(), &arrays_->given, bytes);
                shorter.as<clarity_rays>()->struct_bytes = bytes;
                short_ = std::move(shorter);
            }
        }
        argument_ = short_.size() ? short_.as<clarity_rays>() : given_.get();
        if (!tracer) expect(CLARITY_USAGE, "");
        if (wrong_) spoil(draw);
    }
    const clarity_rays* rays() const { return argument_; }
    const clarity_watch* watch() const { return watch_.get(); }
    const std::vector<Ray>& traced() const { return packed_ ? packed_->rays : arrays_->rays; }
    size_t count() const { return traced().size(); }
    void expect(int32_t code, const char* words) { code_ = code, words_ = words; }
    bool expects_work() const { return code_ == CLARITY_OK && watch_.kind != Watch::Kind::wrong; }
    // A failed call has left these bytes alone. Calls with many rays may be cancelled when the first ones are done.
    void must_leave(const Step& step, const Bytes& bytes, int32_t code) const {
        step.must(bytes.is_untouched() || (code == CLARITY_CANCELLED && count() > 1024), "a failed call has written results");
    }
    // The call has ended.
    void ended(const Step& step, int32_t code) const {
        if (code_ != CLARITY_OK) return step.ended(code, code_, words_);
        watch_.ended(step, code, count() == 0);
    }

 private:
    void spoil(Draw& draw) {
        clarity_rays& rays = *(short_.size() ? short_.as<clarity_rays>() : given_.get());
        switch (draw.below(5)) {
            case 0:
                argument_ = nullptr;
                return expect(CLARITY_USAGE, "clarity_rays is null");
            case 1:
                rays.struct_bytes = draw.one_of({0u, 8u, 95u});
                return expect(CLARITY_USAGE, "clarity_rays::struct_bytes");
            case 2:
                if (packed_) {
                    rays.count = draw.one_of<uint64_t>({rays.count + 1, UINT64_MAX});
                    return expect(CLARITY_USAGE, "packed rays");
                }
                rays.type = draw.one_of({-1, 2, 5, 1 << 30});
                return expect(CLARITY_USAGE, "unknown type");
            case 3:
                if (packed_ || draw.chance(0.5)) break;
                (draw.chance(0.5) ? rays.origins : rays.directions) = nullptr;
                if (rays.count == 0 || draw.chance(0.3)) rays.count = draw.one_of<uint64_t>({1, uint64_t{1} << 63, UINT64_MAX});
                return expect(CLARITY_USAGE, "no origins or no directions");
            default:
                break;
        }
        if (short_.size()) return;  // has no mask
        rays.mask = draw.one_of({256u, 0x80000000u, 0xffffffffu});
        expect(CLARITY_USAGE, "mask");
    }
    const std::shared_ptr<Packed> packed_;
    const bool packed_elsewhere_, wrong_;
    const Watch watch_;
    std::unique_ptr<RayArrays> arrays_;
    Struct<clarity_rays> given_;
    Bytes short_;
    const clarity_rays* argument_ = nullptr;
    int32_t code_ = CLARITY_OK;
    const char* words_ = "";
};

void closest(Step& step) {
    Draw& draw = step.draw;
    const std::shared_ptr<Tracer> tracer = step.state.tracers.any(draw);
    Query query(step, tracer.get(), Query::May::hits);
    const size_t count = query.count();
    Bytes arrays[4];  // t, prim, instance, uv
    for (size_t k = 0; k < 4; ++k)
        if (draw.chance(k < 2 ? 0.9 : 0.5)) arrays[k] = Bytes(count * (k == 3 ? 8 : 4));
    const auto array = [&](size_t k) { return arrays[k].size() || draw.chance(0.5) ? arrays[k].as<void>() : nullptr; };
    clarity_hits hits{};
    hits.t = static_cast<float*>(array(0));
    hits.prim = static_cast<int32_t*>(array(1));
    hits.instance = static_cast<int32_t*>(array(2));
    hits.uv = static_cast<float*>(array(3));
    Struct<clarity_hits> given(draw, hits);
    const clarity_hits* argument = given.get();
    if (query.expects_work() && draw.chance(0.03)) {
        if (draw.chance(0.5))
            argument = nullptr, query.expect(CLARITY_USAGE, "clarity_hits is null");
        else
            given.spoil(draw.one_of({0u, 8u, uint32_t(sizeof hits - 1)})),
                query.expect(CLARITY_USAGE, "clarity_hits::struct_bytes");
    }
    std::vector<std::shared_ptr<const World>> worlds;
    ++calls_made;
    int32_t code;
    if (tracer) {
        const Meanwhile meanwhile(*tracer);
        code = clarity_closest(tracer->handle, query.rays(), argument, query.watch());
        worlds = meanwhile.worlds();
    } else {
        code = clarity_closest(nullptr, query.rays(), argument, query.watch());
    }
    query.ended(step, code);
    if (code != CLARITY_OK) {
        for (const Bytes& bytes : arrays) query.must_leave(step, bytes, code);
        return;
    }
    if (!hits.t) return;
    const std::string why = compared(worlds, count, [&](const World& world, size_t i) {
        const auto number = [&](const int32_t* all) { return all ? all + i : nullptr; };
        return fault_of_closest(world, query.traced()[i],
                                {hits.t[i], number(hits.prim), number(hits.instance), hits.uv ? hits.uv + 2 * i : nullptr});
    });
    if (!why.empty()) step.fail(tracer->accel + ": " + why);
}

void any(Step& step) {
    Draw& draw = step.draw;
    const std::shared_ptr<Tracer> tracer = step.state.tracers.any(draw);
    Query query(step, tracer.get(), Query::May::hits);
    Bytes occluded(query.count());
    uint8_t* to = occluded.as<uint8_t>();
    if (query.expects_work() && query.count() > 0 && draw.chance(0.03))
        to = nullptr, query.expect(CLARITY_USAGE, "`occluded` is null");
    std::vector<std::shared_ptr<const World>> worlds;
    ++calls_made;
    int32_t code;
    if (tracer) {
        const Meanwhile meanwhile(*tracer);
        code = clarity_any(tracer->handle, query.rays(), to, query.watch());
        worlds = meanwhile.worlds();
    } else {
        code = clarity_any(nullptr, query.rays(), to, query.watch());
    }
    query.ended(step, code);
    if (code != CLARITY_OK) return query.must_leave(step, occluded, code);
    const std::string why = compared(worlds, query.count(), [&](const World& world, size_t i) {
        if (to[i] > 1) return "occluded is " + std::to_string(to[i]);
        return fault_of_any(world, query.traced()[i], to[i] == 1);
    });
    if (!why.empty()) step.fail(tracer->accel + ": " + why);
}

void count_hits(Step& step) {
    Draw& draw = step.draw;
    const std::shared_ptr<Tracer> tracer = step.state.tracers.any(draw);
    Query query(step, tracer.get(), Query::May::all);
    Bytes counts(query.count() * sizeof(int64_t));
    int64_t* to = counts.as<int64_t>();
    if (query.expects_work() && query.count() > 0 && draw.chance(0.03))
        to = nullptr, query.expect(CLARITY_USAGE, "`counts` is null");
    std::vector<std::shared_ptr<const World>> worlds;
    ++calls_made;
    int32_t code;
    if (tracer) {
        const Meanwhile meanwhile(*tracer);
        code = clarity_count(tracer->handle, query.rays(), to, query.watch());
        worlds = meanwhile.worlds();
    } else {
        code = clarity_count(nullptr, query.rays(), to, query.watch());
    }
    query.ended(step, code);
    if (code != CLARITY_OK) return query.must_leave(step, counts, code);
    const std::string why = compared(
        worlds, query.count(), [&](const World& world, size_t i) { return fault_of_count(world, query.traced()[i], to[i]); });
    if (!why.empty()) step.fail(tracer->accel + ": " + why);
}

// Hits of all rays, which may be read long after their tracer is gone.
void check_all(const Step& step, const AllHits& all) {
    const clarity_all_hits& hits = all.hits;
    const size_t count = all.rays.size();
    step.must(hits.first[0] == 0 && hits.first[count] == int64_t(hits.count),
              "the list of hits does not begin at 0 and end at `count`");
    for (size_t i = 0; i < count; ++i) {
        step.must(hits.first[i] <= hits.first[i + 1], "the list of hits goes back");
        for (int64_t at = hits.first[i]; at < hits.first[i + 1]; ++at)
            step.must(hits.ray[at] == int64_t(i), "a hit of another ray");
    }
    const std::string why = compared(all.worlds, count, [&](const World& world, size_t i) {
        const size_t begin = size_t(hits.first[i]), some = size_t(hits.first[i + 1]) - begin;
        for (size_t k = begin; k < begin + some; ++k)
            if (hits.instance[k] < -1 || hits.instance[k] >= world.instance_count)
                return "instance " + std::to_string(hits.instance[k]);
        return fault_of_all(world, all.rays[i], hits.t + begin, hits.prim + begin, some);
    });
    if (!why.empty()) step.fail(why);
}

void all_hits(Step& step) {
    Draw& draw = step.draw;
    const std::shared_ptr<Tracer> tracer = step.state.tracers.any(draw);
    Query query(step, tracer.get(), Query::May::all);
    const auto all = std::make_shared<AllHits>();
    all->hits.struct_bytes = sizeof all->hits;
    clarity_all_hits* to = &all->hits;
    if (query.expects_work() && draw.chance(0.05)) {
        if (draw.chance(0.5))
            to = nullptr, query.expect(CLARITY_USAGE, "clarity_all_hits is null");
        else
            to->struct_bytes = 12, query.expect(CLARITY_USAGE, "clarity_all_hits::struct_bytes");
    }
    ++calls_made;
    int32_t code;
    if (tracer) {
        const Meanwhile meanwhile(*tracer);
        code = clarity_all(tracer->handle, query.rays(), to, query.watch());
        all->worlds = meanwhile.worlds();
    } else {
        code = clarity_all(nullptr, query.rays(), to, query.watch());
    }
    query.ended(step, code);
    if (code != CLARITY_OK)
        return step.must(!all->hits.owner && !all->hits.t && all->hits.count == 0, "a failed call has written a list");
    all->rays = query.traced();
    check_all(step, *all);
    step.state.all_hits.put(draw, all);
}

void all_hits_late(Step& step) {
    if (const auto all = step.state.all_hits.any(step.draw)) check_all(step, *all);
    if (step.draw.chance(0.5)) return step.state.all_hits.put(step.draw, nullptr);
    clarity_all_hits nothing{};
    calls_made += 2;
    clarity_all_hits_free(&nothing);
    clarity_all_hits_free(nullptr);
}

void pack(Step& step) {
    Draw& draw = step.draw;
    const std::shared_ptr<Tracer> tracer = step.state.tracers.any(draw);
    Query query(step, tracer.get(), Query::May::all);
    const auto packed = std::make_shared<Packed>();
    clarity_packed** to = &packed->handle;
    if (query.expects_work() && draw.chance(0.05)) to = nullptr, query.expect(CLARITY_USAGE, "`packed` is null");
    ++calls_made;
    const int32_t code = clarity_pack(tracer ? tracer->handle : nullptr, query.rays(), query.watch(), to);
    query.ended(step, code);
    step.must((code == CLARITY_OK) == (packed->handle != nullptr), "packed rays without CLARITY_OK, or the reverse");
    if (code != CLARITY_OK) return;
    packed->rays = query.traced();
    packed->tracer = tracer;
    step.state.packed.put(draw, packed);
}

void packed_free(Step& step) {
    step.state.packed.put(step.draw, nullptr);
}

void kept_new(Step& step) {
    Draw& draw = step.draw;
    const std::shared_ptr<Tracer> tracer = step.state.tracers.any(draw);
    const auto kept = std::make_shared<Kept>();
    const bool wrong = draw.chance(0.1);
    kept->brief = draw.chance(0.4);
    ++calls_made;
    const int32_t code = clarity_kept_new(tracer ? tracer->handle : nullptr, kept->brief ? draw.one_of({1, -1, 1 << 30}) : 0,
                                          wrong ? nullptr : &kept->handle);
    if (wrong || !tracer) return step.ended(code, CLARITY_USAGE, "is null");
    step.ended(code);
    kept->tracer = tracer;
    step.state.kept.put(draw, kept);
}

void kept_free(Step& step) {
    step.state.kept.put(step.draw, nullptr);
}

// With `use`: what is in the arrays that were asked for.
void check_kept(const Step& step, const Kept& kept) {
    if (!kept.asked[CLARITY_HIT_T] || !kept.has_hits) return;
    const auto array = [&](int which) { return kept.asked[which] ? kept.arrays[which] : nullptr; };
    const auto* const t = static_cast<const float*>(array(CLARITY_HIT_T));
    const auto* const prim = static_cast<const int32_t*>(array(CLARITY_HIT_PRIM));
    const auto* const instance = static_cast<const int32_t*>(kept.brief ? nullptr : array(CLARITY_HIT_INSTANCE));
    const auto* const uv = static_cast<const float*>(kept.brief ? nullptr : array(CLARITY_HIT_UV));
    const std::string why = compared(kept.worlds, kept.rays.size(), [&](const World& world, size_t i) {
        const auto number = [&](const int32_t* all) { return all ? all + i : nullptr; };
        return fault_of_closest(world, kept.rays[i], {t[i], number(prim), number(instance), uv ? uv + 2 * i : nullptr});
    });
    if (!why.empty()) step.fail("kept hits: " + why);
}

void keep(Step& step) {
    Draw& draw = step.draw;
    const std::shared_ptr<Tracer> tracer = step.state.tracers.any(draw);
    const std::shared_ptr<Kept> kept = step.state.kept.any(draw);
    if (!tracer || !kept) {
        Query query(step, tracer.get(), Query::May::hits);
        query.expect(CLARITY_USAGE, "");
        ++calls_made;
        const int32_t code =
            clarity_keep(tracer ? tracer->handle : nullptr, query.rays(), kept ? kept->handle : nullptr, query.watch());
        return query.ended(step, code);
    }
    const std::lock_guard<std::mutex> use(kept->use);
    const bool asked = std::any_of(std::begin(kept->asked), std::end(kept->asked), [](bool is) { return is; });
    const size_t as_before = kept->rays.size();
    Query query(step, tracer.get(), Query::May::hits, asked && draw.chance(0.7) ? &as_before : nullptr);
    ++calls_made;
    if (query.expects_work() && kept->tracer.lock() != tracer)
        query.expect(CLARITY_USAGE, "another tracer");
    else if (query.expects_work() && asked && query.count() != kept->rays.size())
        query.expect(CLARITY_USAGE, "arrays are in use");
    const Meanwhile meanwhile(*tracer);
    const int32_t code = clarity_keep(tracer->handle, query.rays(), kept->handle, query.watch());
    query.ended(step, code);
    if (code != CLARITY_OK) {
        if (code != CLARITY_USAGE) kept->has_hits = false;
        return;
    }
    kept->rays = query.traced();
    kept->worlds = meanwhile.worlds();
    kept->has_hits = true;
    check_kept(step, *kept);  // in the arrays that were asked for before
}

void kept_array(Step& step) {
    Draw& draw = step.draw;
    const std::shared_ptr<Kept> kept = step.state.kept.any(draw);
    const bool wrong = draw.chance(0.1), null_array = wrong && draw.chance(0.5);
    const int32_t which = wrong && !null_array ? draw.one_of({-1, 4, 1 << 30}) : draw.one_of({0, 0, 1, 2, 3});
    void* array = nullptr;
    ++calls_made;
    if (!kept || wrong) {
        const int32_t code = clarity_kept_array(kept ? kept->handle : nullptr, which, null_array ? nullptr : &array);
        return step.ended(code, CLARITY_USAGE, "");
    }
    const std::lock_guard<std::mutex> use(kept->use);
    const int32_t code = clarity_kept_array(kept->handle, which, &array);
    if (!kept->has_hits) return step.ended(code, CLARITY_USAGE, "no hits");
    step.ended(code);
    step.must(array != nullptr, "an array of kept hits is null");
    step.must(!kept->asked[which] || kept->arrays[which] == array, "an array of kept hits has moved");
    kept->asked[which] = true;
    kept->arrays[which] = array;
    check_kept(step, *kept);
}

}  // namespace

const std::vector<Call> kRayCalls = {
    {"clarity_closest", 30, closest},
    {"clarity_any", 16, any},
    {"clarity_count", 6, count_hits},
    {"clarity_all", 6, all_hits},
    {"clarity_all_hits_free", 5, all_hits_late},
    {"clarity_pack", 5, pack},
    {"clarity_packed_free", 2, packed_free},
    {"clarity_kept_new", 4, kept_new},
    {"clarity_kept_free", 1, kept_free},
    {"clarity_keep", 10, keep},
    {"clarity_kept_array", 12, kept_array},
};

}  // namespace sequences

// The library that knows MPI: mpi_module.h explains it.
#include "mpi/mpi_module.h"

#include <mpi.h>

#include <algorithm>
#include <string>

namespace {

// MPI counts elements in an int, and some implementations bytes, too: pieces stay well below 2 GiB.
constexpr uint64_t kPiece = uint64_t{256} << 20;

MPI_Comm host_ranks = MPI_COMM_NULL, receiving_ranks = MPI_COMM_NULL;

const char* failure(int code) {
    static std::string text;
    if (code == MPI_SUCCESS) return nullptr;
    char reason[MPI_MAX_ERROR_STRING] = "";
    int length = 0;
    MPI_Error_string(code, reason, &length);
    text.assign(reason, static_cast<size_t>(length));
    return text.c_str();
}

template <class Call>
const char* in_pieces(uint64_t size, const Call& call) {
    for (uint64_t at = 0; at < size; at += kPiece)
        if (const char* why = failure(call(at, static_cast<int>(std::min(kPiece, size - at))))) return why;
    return nullptr;
}

const char* begin(unsigned* rank, unsigned* count, unsigned* here, unsigned* here_count) {
    int provided = 0;
    if (const char* why = failure(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided))) return why;
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    int numbers[4] = {};
    int code = MPI_Comm_rank(MPI_COMM_WORLD, &numbers[0]);
    if (code == MPI_SUCCESS) code = MPI_Comm_size(MPI_COMM_WORLD, &numbers[1]);
    if (code == MPI_SUCCESS) code = MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &host_ranks);
    if (code == MPI_SUCCESS) code = MPI_Comm_rank(host_ranks, &numbers[2]);
    if (code == MPI_SUCCESS) code = MPI_Comm_size(host_ranks, &numbers[3]);
    unsigned* const out[4] = {rank, count, here, here_count};
    for (int i = 0; i < 4; ++i) *out[i] = static_cast<unsigned>(numbers[i]);
    return failure(code);
}

const char* end() {
    return failure(MPI_Finalize());
}

const char* from_first(MPI_Comm ranks, void* bytes, uint64_t size) {
    auto* const all = static_cast<char*>(bytes);
    return in_pieces(size, [&](uint64_t at, int count) { return MPI_Bcast(all + at, count, MPI_BYTE, 0, ranks); });
}

const char* tell_host(void* bytes, uint64_t size) {
    return from_first(host_ranks, bytes, size);
}

const char* receivers(int takes_part) {
    int code = MPI_SUCCESS;
    if (receiving_ranks != MPI_COMM_NULL) code = MPI_Comm_free(&receiving_ranks);
    if (code == MPI_SUCCESS) code = MPI_Comm_split(MPI_COMM_WORLD, takes_part ? 0 : MPI_UNDEFINED, 0, &receiving_ranks);
    return failure(code);
}

const char* broadcast(void* bytes, uint64_t size) {
    return from_first(receiving_ranks, bytes, size);
}

const char* gather(double mine, double* all) {
    return failure(MPI_Allgather(&mine, 1, MPI_DOUBLE, all, 1, MPI_DOUBLE, MPI_COMM_WORLD));
}

const char* send(const void* bytes, uint64_t size) {
    const auto* const all = static_cast<const char*>(bytes);
    return in_pieces(size, [&](uint64_t at, int count) { return MPI_Send(all + at, count, MPI_BYTE, 0, 0, MPI_COMM_WORLD); });
}

const char* receive(unsigned from, void* bytes, uint64_t size) {
    auto* const all = static_cast<char*>(bytes);
    return in_pieces(size, [&](uint64_t at, int count) {
        return MPI_Recv(all + at, count, MPI_BYTE, static_cast<int>(from), 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    });
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const clarity_mpi_module clarity_mpi_module_v2;
const clarity_mpi_module clarity_mpi_module_v2 = {begin, end, tell_host, receivers, broadcast, gather, send, receive};

/* mpi_module.h -- between the program and the library that knows MPI. The program needs no MPI: only --mpi loads the library. Both
 * are built together; the number in the symbol tells a library that is not of this program. */
#ifndef CLARITY_MPI_MODULE_H
#define CLARITY_MPI_MODULE_H
#include <stdint.h>

/* Calls come from one thread. Functions return NULL, or why they failed; the text stays valid until the next call. */
typedef struct clarity_mpi_module {
    /* Begins MPI. here: the number of this process among those of its host; here_count: how many those are. */
    const char *(*begin)(unsigned *rank, unsigned *count, unsigned *here, unsigned *here_count);
    const char *(*end)(void); /* waits for all ranks */
    /* The bytes of the first process of each host go to the others of that host. */
    const char *(*tell_host)(void *bytes, uint64_t size);
    /* Chooses the ranks that take part in later broadcasts. All ranks call it: with 1 to take part, else with 0. Rank 0 gives 1. */
    const char *(*receivers)(int takes_part);
    /* The bytes of rank 0 go to all that take part, which alone call it. Any size. */
    const char *(*broadcast)(void *bytes, uint64_t size);
    /* all[r] becomes the number that rank r gave, on all ranks. */
    const char *(*gather)(double mine, double *all);
    /* To rank 0, which receives from each of the others in turn. Any size; both know it. */
    const char *(*send)(const void *bytes, uint64_t size);
    const char *(*receive)(unsigned from, void *bytes, uint64_t size);
} clarity_mpi_module;

#define CLARITY_MPI_MODULE_SYMBOL "clarity_mpi_module_v2"
#endif

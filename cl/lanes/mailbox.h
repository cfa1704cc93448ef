/* mailbox.h -- remembers the primitives that a ray was tested against last, where several cells name the same primitive.
 *
 * Amanatides, Woo 1987, "A Fast Voxel Traversal Algorithm for Ray Tracing", give each ray a number and each primitive the number
 * of its last ray. Rays in parallel cannot write into primitives. So each ray keeps a few positions of its own, each in the place
 * that its lowest bits name: Benthin 2006, "Realtime Ray Tracing on current CPU Architectures" (hashed mailboxes). A position
 * that was forgotten is tested again, which changes nothing but time.
 *
 * Packets may use it, too, because RT_LEAF tests all lanes that still search. */
#ifndef RT_MAILBOX_H
#define RT_MAILBOX_H

/* On a CPU more places cost only their clearing, and save a packet a third of its tests in a grid. On a GPU each ray has its own. */
#if RT_CPU
#define RT_MAILBOX_SIZE 64u
#else
#define RT_MAILBOX_SIZE 8u
#endif

typedef struct rt_mailbox {
    uint at[RT_MAILBOX_SIZE];
} rt_mailbox;

RT_INLINE void rt_clear_mailbox(rt_mailbox *box)
{
    for (uint i = 0; i < RT_MAILBOX_SIZE; ++i) box->at[i] = RT_NONE;
}

/* Whether the primitive at this position was tested lately. If not, it will be from now on. */
RT_INLINE bool rt_was_tested(rt_mailbox *box, uint at)
{
    uint *const place = box->at + at % RT_MAILBOX_SIZE;
    if (*place == at) return true;
    *place = at;
    return false;
}

#endif

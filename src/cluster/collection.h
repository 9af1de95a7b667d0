/* The results that servers send in parts: states, compiled from the STATE messages of all servers, and
 * profiles, summed over their PROFILE messages. A state or a profile is written once every server has sent
 * its whole part.
 *
 * collection_expect and collection_expect_profiles make parts of one step due, collection_write and
 * collection_write_profiles end that. A part that is not due is a DM2_PROTOCOL failure of its server. */
#ifndef DM2_CLUSTER_COLLECTION_H
#define DM2_CLUSTER_COLLECTION_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/cluster/client.h"
#include "dm2/cluster/messages.h"
#include "dm2/engine/loading.h"
#include "dm2/engine/wall_outline.h"
#include "dm2/engine/profile.h"
#include "dm2/net/frame.h"
#include "conversation.h"
#include "course.h"
#include "state_merge.h"

/* A state whose parts are coming. */
struct compilation {
    struct state_merge merge;
    bool due; /* parts of the state at `step` may come */
    int64_t step;
    bool *whole; /* [ranks] the last part of this server has come */
};

/* A profile whose parts are coming. */
struct profile_part {
    struct profile_bin *bins; /* sums so far */
    bool *came;               /* [ranks] the part of this server has come */
    bool due;
};

struct collection {
    const struct client_job *job;  /* NULL: nothing is ever due */
    struct course *course;         /* keeps the copies */
    struct conversation *talk;     /* for failures of servers */
    const struct loading *loading; /* for the states of bodies under force; NULL: there are none */
    struct wall_outlines outlines; /* of the last snapshot */
    struct compilation snapshot, final, copy;
    struct profile_part *profiles; /* [config->n_profiles] */
    int64_t profile_step;          /* the step of all profiles */
};

/* Prepares for the servers of `talk`. The pointers are borrowed until collection_close, which frees the rest.
 * DM2_MEMORY. */
enum dm2_status collection_open(struct collection *c, const struct client_job *job, struct course *course,
                                struct conversation *talk, struct dm2_error *err);
void collection_close(struct collection *c);

/* due: empties the state of this purpose and makes its parts, of `step`, due. Else no part of that purpose is
 * due. */
void collection_expect(struct collection *c, enum state_purpose purpose, bool due, int64_t step);

/* Empties all profiles and makes the profiles due that the deck wants at `step`. */
void collection_expect_profiles(struct collection *c, int64_t step);

/* Takes a STATE or PROFILE frame of one server. False: the frame is of another type. True: *status is the
 * result; DM2_PROTOCOL: the frame is not due or does not decode; DM2_MEMORY. */
bool collection_take(struct collection *c, int rank, const struct frame *frame, enum dm2_status *status,
                     struct dm2_error *err);

/* Notes where the walls are, for the snapshot of the step of *c->loading; before the bodies under force move
 * on. DM2_MEMORY. */
enum dm2_status collection_place_walls(struct collection *c, struct dm2_error *err);

/* Completes the state of this purpose: writes a snapshot or the final state to the results, gives a copy to
 * the course. DM2_PROTOCOL: a server's part is missing, or the state is not whole; DM2_IO, DM2_MEMORY. */
enum dm2_status collection_write(struct collection *c, enum state_purpose purpose, struct dm2_error *err);

/* Writes all profiles that are due to the results. DM2_PROTOCOL: the part of a server is missing; DM2_IO,
 * DM2_MEMORY. */
enum dm2_status collection_write_profiles(struct collection *c, struct dm2_error *err);

#endif

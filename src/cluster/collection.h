/* What comes from the servers in parts: states, compiled from the STATE messages of all servers, and
 * profiles, summed over their PROFILE messages. Each is written once every server has sent its whole part.
 *
 * A part is taken only while it is due: collection_expect says of which step, collection_write ends that. */
#ifndef DM2_CLUSTER_COLLECTION_H
#define DM2_CLUSTER_COLLECTION_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/cluster/client.h"
#include "dm2/cluster/messages.h"
#include "dm2/engine/profile.h"
#include "dm2/net/frame.h"
#include "conversation.h"
#include "course.h"
#include "state_merge.h"

/* A state on its way in. */
struct compilation {
    struct state_merge merge;
    bool due;     /* parts may come now, */
    int64_t step; /* of this step */
    bool *whole;  /* [ranks] its part has come: all of it */
};

/* The sums of a profile on their way in. */
struct profile_part {
    struct profile_bin *bins;
    bool *came; /* from which server */
    bool due;
};

struct collection {
    const struct client_job *job; /* NULL: nothing is ever due */
    struct course *course;        /* takes the copies */
    struct conversation *talk;    /* names the servers in failures */
    struct compilation snapshot, final, copy;
    struct profile_part *profiles; /* of the deck */
    int64_t profile_step;          /* that they are of */
};

/* For the servers of `talk`. All pointers are borrowed. DM2_MEMORY. */
enum dm2_status collection_open(struct collection *c, const struct client_job *job, struct course *course,
                                struct conversation *talk, struct dm2_error *err);
void collection_close(struct collection *c);

/* Begins a state anew. due: its parts, of the state `step`, may come now. */
void collection_expect(struct collection *c, enum state_purpose purpose, bool due, int64_t step);

/* Begins anew the sums of all profiles; those that the deck wants at `step` may come now. */
void collection_expect_profiles(struct collection *c, int64_t step);

/* Takes a STATE or PROFILE frame of one server; false: it is another one. *status then says how that ended:
 * DM2_PROTOCOL where the frame is not due or does not decode, DM2_MEMORY. */
bool collection_take(struct collection *c, int rank, const struct frame *frame, enum dm2_status *status,
                     struct dm2_error *err);

/* Writes the state that has come whole: a snapshot or the final state into the results; a copy goes to the
 * course. DM2_PROTOCOL where a server's part is missing; DM2_IO, DM2_MEMORY. */
enum dm2_status collection_write(struct collection *c, enum state_purpose purpose, struct dm2_error *err);

/* Writes the profiles that were due. Errors as above. */
enum dm2_status collection_write_profiles(struct collection *c, struct dm2_error *err);

#endif

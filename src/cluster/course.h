/* The course of a run: what lasts from one session to the next.
 *
 * A session ends with the loss of a server. The course then decides which servers the next session has and
 * which state that session starts from: the last copy of the state, else the job's. A step may be done twice,
 * by two sessions; its results and its hash are taken once. */
#ifndef DM2_CLUSTER_COURSE_H
#define DM2_CLUSTER_COURSE_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/cluster/client.h"
#include "dm2/cluster/decomposition.h"
#include "dm2/cluster/hosts.h"
#include "dm2/cluster/report.h"
#include "dm2/engine/element.h"
#include "copies.h"
#include "state_merge.h"

/* A server of the course. */
struct station {
    struct endpoint at;
    int losses; /* since the last copy */
};

struct course {
    struct station *stations; /* ranks of them */
    size_t spares_used;
    struct decomposition cut;                  /* for fewer servers than at first, */
    const struct decomposition *decomposition; /* or the job's */
    struct state_merge copy;                   /* the state of the step copy_step; -1: none */
    int64_t copy_step;
    struct copy_plan plan;
    int64_t checkpoint_every; /* steps between checkpoints; 0: none */
    int64_t hashed;           /* the newest step whose hash was told; -1: none */
    bool stepping;            /* all servers of the first session were ready */
    bool stopping;            /* a signal came while the steps ran */
    int renewals;             /* of all servers, since the last copy */
    struct run_report report;
};

/* The servers are options->servers[0 .. ranks-1]. job NULL: only the network is measured. DM2_MEMORY. */
enum dm2_status course_open(struct course *course, const struct client_job *job,
                            const struct client_options *options, int ranks, struct dm2_error *err);
void course_close(struct course *course);

/* The state to start from: the last copy, else the job's. Its arrays belong to the course and the job. False:
 * the run starts from the beginning, *out is as it was. */
bool course_state(const struct course *course, const struct client_job *job, struct state_view *out);

/* The step of that state; 0: the beginning. */
int64_t course_step(const struct course *course, const struct client_job *job);

/* Whether the state at `step` is to come with its STEP message; if so, the course counts it as asked for. */
bool course_wants_copy(struct course *course, const struct client_job *job, int64_t step);

/* Takes the compiled state of `step` out of *state as the copy to go back to, and leaves the old one there.
 * Writes it as a checkpoint where one is due. DM2_IO, DM2_MEMORY. */
enum dm2_status course_keep_copy(struct course *course, const struct client_job *job,
                                 struct state_merge *state, int64_t step, struct dm2_error *err);

/* The step to the state `step` took `seconds`, with compiling what came: `copy`, a copy; `snapshot`, a
 * snapshot. Counted for the distance of copies and for the report. */
void course_note_copy(struct course *course, const struct client_job *job, int64_t step, bool copy,
                      bool snapshot, double seconds);

/* Tells the user the hash of the state at `step`: once, however often that step is done. */
void course_tell_hash(struct course *course, const struct client_options *options, int64_t step,
                      uint64_t hash);

/* Gives the user a line of text (options->events.note). */
void course_tell(const struct client_options *options, const char *line);

/* Can the run go on after a session that failed with `status` by the rank `culprit` (-1: by none)? */
bool course_goes_on(const struct course *course, const struct client_options *options, enum dm2_status status,
                    int culprit);

/* Decides which server takes the place of the lost rank: all servers anew, the same one once more, a spare,
 * or none, with the domain cut for the others. absent: the server is not there any more, or silent. Tells the
 * user. DM2_NET: no server is left, or servers were lost too often without a new copy; DM2_MEMORY; what
 * options->renew returns. */
enum dm2_status course_replace(struct course *course, const struct client_job *job,
                               const struct client_options *options, int lost, bool absent,
                               struct dm2_error *err);

/* After a run that failed with `status`: writes the copy as a checkpoint where it is newer than the last one,
 * unless the disk is what failed. Failures are ignored. */
void course_leave_checkpoint(const struct course *course, const struct client_job *job,
                             enum dm2_status status);

#endif

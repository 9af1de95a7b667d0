/* The course of a run: the data that last from one session to the next.
 *
 * A session may end with the loss of a server. The course then chooses the servers of the next session and
 * the state from which this session starts: the last copy of the state, else the state of the job. Two
 * sessions may compute the same step; its results are written once and its hash is told once. */
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
    struct station *stations; /* [ranks] */
    size_t spares_used;
    struct decomposition cut; /* the domain cut for fewer servers; empty: not needed so far */
    const struct decomposition *decomposition; /* the job's, later &cut */
    struct state_merge copy;                   /* the last copy of the state, of the step copy_step */
    int64_t copy_step;                         /* -1: no copy yet */
    struct copy_plan plan;
    int64_t checkpoint_every; /* steps between checkpoints; 0: none */
    int64_t hashed;           /* the newest step whose hash was told; -1: none */
    bool stepping;            /* all servers have once been ready */
    bool stopping;            /* a signal came during the steps */
    int renewals;             /* of all servers, since the last copy */
    struct run_report report;
};

/* Starts the course with the servers options->servers[0 .. ranks-1]. job NULL: only the network is measured.
 * course_close frees what *course owns. DM2_MEMORY. */
enum dm2_status course_open(struct course *course, const struct client_job *job,
                            const struct client_options *options, int ranks, struct dm2_error *err);
void course_close(struct course *course);

/* The state from which a session starts: the last copy, else the state of the job. The arrays belong to the
 * course or the job. False: the run starts at the beginning, *out is unchanged. */
bool course_state(const struct course *course, const struct client_job *job, struct state_view *out);

/* The step of course_state; 0 at the beginning. */
int64_t course_step(const struct course *course, const struct client_job *job);

/* Whether the servers must send the state at `step` with its STEP message: for a copy, a checkpoint, or the
 * end of the run after a signal. If so, the plan of copies records that the state has been asked for. */
bool course_wants_copy(struct course *course, const struct client_job *job, int64_t step);

/* Exchanges *state, the compiled state of `step`, with the last copy, and writes the new copy as a checkpoint
 * where a checkpoint is due. DM2_IO, DM2_MEMORY. */
enum dm2_status course_keep_copy(struct course *course, const struct client_job *job,
                                 struct state_merge *state, int64_t step, struct dm2_error *err);

/* Records the seconds of the step to the state `step` for the plan of copies and the report. copy, snapshot:
 * a copy, a snapshot came with the step; the seconds include its compilation. */
void course_note_copy(struct course *course, const struct client_job *job, int64_t step, bool copy,
                      bool snapshot, double seconds);

/* Tells the user the hash of the state at `step` (options->events.hash), once per step. */
void course_tell_hash(struct course *course, const struct client_options *options, int64_t step,
                      uint64_t hash);

/* Tells the user a line of text (options->events.note). */
void course_tell_user(const struct client_options *options, const char *line);

/* Whether the run can continue after a session that failed with `status`. culprit: the rank that failed; -1:
 * none. */
bool course_goes_on(const struct course *course, const struct client_options *options, enum dm2_status status,
                    int culprit);

/* Chooses the server that replaces the lost rank, and tells the user: all servers started anew
 * (options->renew), or the same server once more, or a spare, or none, with the domain cut for the remaining
 * servers. absent: the lost server was silent or could not be reached. DM2_NET: no server is left, or servers
 * were lost too often without a new copy; DM2_MEMORY; any status of options->renew. */
enum dm2_status course_replace(struct course *course, const struct client_job *job,
                               const struct client_options *options, int lost, bool absent,
                               struct dm2_error *err);

/* After a run that failed with `status`: writes the last copy as a checkpoint if the copy is newer than the
 * last checkpoint. Not after DM2_IO, because the disk has failed. Returns `status`; where an
 * interrupted run could not be saved, the failure to write. */
enum dm2_status course_leave_checkpoint(const struct course *course, const struct client_job *job,
                                        enum dm2_status status, struct dm2_error *err);

#endif

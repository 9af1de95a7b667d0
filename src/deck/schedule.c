/* Pure functions of a config and a step. */
#include "dm2/deck/schedule.h"

bool schedule_history(const struct config *c, int64_t step)
{
    return step == c->steps || (c->output.history_every > 0 && step % c->output.history_every == 0);
}

bool schedule_snapshot(const struct config *c, int64_t step)
{
    if (c->output.snapshot_every > 0 && step % c->output.snapshot_every == 0)
        return true;
    for (size_t i = 0; i < c->output.n_snapshot_at; i++)
        if (c->output.snapshot_at[i] == step)
            return true;
    return false;
}

bool schedule_profile(const struct config *c, size_t which, int64_t step)
{
    return step == c->steps || step % c->profiles[which].every == 0;
}

bool schedule_limit(const struct config *c, int64_t step)
{
    static const int64_t apart = 10; /* the sums of the limit cost as much as two steps */
    int64_t every = c->output.history_every, rows = (apart + every - 1) / every;
    return step == c->n_start || (schedule_history(c, step) && step % (rows * every) == 0);
}

bool schedule_measure(const struct config *c, int64_t step)
{
    bool due = step == c->n_start || schedule_history(c, step) || schedule_snapshot(c, step);
    for (size_t k = 0; k < c->n_profiles; k++)
        due |= schedule_profile(c, k, step);
    return due;
}

bool schedule_checkpoint(const struct config *c, int64_t every, int64_t step)
{
    return every > 0 && step > c->n_start && step < c->steps && step % every == 0;
}

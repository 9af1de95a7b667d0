/* The names of snapshots, and the ParaView collection of a run. */
#include "snapshot.h"

#include <inttypes.h>
#include <stdio.h>

#include "dm2/base/file.h"
#include "dm2/base/number.h"

void snapshot_file_name(int64_t step, const char *suffix, char out[SNAPSHOT_NAME_MAX])
{
    (void)snprintf(out, SNAPSHOT_NAME_MAX, "state-%09" PRId64 ".%s", step, suffix);
}

enum dm2_status snapshot_write_series(const char *path, const int64_t *steps, size_t n_steps,
                                      const struct config *config, struct dm2_error *err)
{
    struct file_out f;
    enum dm2_status status = file_create(&f, path, err);
    if (status != DM2_OK)
        return status;
    file_puts(&f,
              "<?xml version=\"1.0\"?>\n"
              "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>\n");
    for (size_t i = 0; i < n_steps; i++) {
        char name[SNAPSHOT_NAME_MAX], time[NUMBER_TEXT_MAX];
        snapshot_file_name(steps[i], "vtp", name);
        number_format(config_time(config, steps[i]), time);
        file_printf(&f, "    <DataSet timestep=\"%s\" group=\"\" part=\"0\" file=\"%s\"/>\n", time, name);
    }
    file_puts(&f, "  </Collection>\n</VTKFile>\n");
    return file_commit(&f, err);
}

/* The version of the programs: --version prints it, and client and server exchange it. */
#ifndef DM2_BASE_VERSION_H
#define DM2_BASE_VERSION_H

#define DM2_VERSION "1.0.0"

#endif

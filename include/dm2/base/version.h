/* The version of the programs; --version prints it, client and server tell it each other. */
#ifndef DM2_BASE_VERSION_H
#define DM2_BASE_VERSION_H

#define DM2_VERSION "1.0.0"

#endif

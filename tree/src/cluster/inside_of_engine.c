#include "engine/inside.h"

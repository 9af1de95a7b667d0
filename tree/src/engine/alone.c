#include "dm2/engine/alone.h"

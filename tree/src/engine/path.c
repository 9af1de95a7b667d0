#include "../net/x.h"

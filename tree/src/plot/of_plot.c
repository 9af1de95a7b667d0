#include <stdio.h>
#include "dm2/base/in_base.h"

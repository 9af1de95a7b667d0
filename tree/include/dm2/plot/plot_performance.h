  #  include "dm2/performance/in_performance.h"

  #  include "dm2/output/in_output.h"

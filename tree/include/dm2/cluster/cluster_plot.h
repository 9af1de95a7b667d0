  #  include "dm2/plot/in_plot.h"

  #  include "dm2/cluster/in_cluster.h"

  #  include "dm2/engine/in_engine.h"

#include <stdio.h>
#include "dm2/deck/in_deck.h"
#include <stdio.h>
#include "dm2/base/in_base.h"
#include <stdio.h>
#include "dm2/engine/in_engine.h"

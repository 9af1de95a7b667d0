#include <stdio.h>
#include "dm2/output/in_output.h"
#include <stdio.h>
#include "dm2/engine/in_engine.h"
#include <stdio.h>
#include "dm2/deck/in_deck.h"
#include <stdio.h>
#include "dm2/net/in_net.h"

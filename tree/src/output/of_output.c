#include <stdio.h>
#include "dm2/engine/in_engine.h"
#include <stdio.h>
#include "dm2/deck/in_deck.h"

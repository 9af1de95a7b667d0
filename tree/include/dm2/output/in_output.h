# include "dm2/engine/in_engine.h"
# include "dm2/deck/in_deck.h"

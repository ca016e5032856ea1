"""The Novint Falcon, from the bytes on its wire to newtons on a hand."""

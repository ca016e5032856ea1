"""The page: a surface seen, heard and felt in the browser of one's own machine."""

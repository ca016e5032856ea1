"""The page of `tangible ui`: a surface seen, heard and felt in the browser of this machine."""

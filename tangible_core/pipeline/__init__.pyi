from .feeling import Feeling as Feeling
from .pipeline import Pipeline as Pipeline
from .starter import SIDE_MM as SIDE_MM
from .starter import are_pictures as are_pictures
from .starter import not_pictures as not_pictures
from .starter import scene_key as scene_key

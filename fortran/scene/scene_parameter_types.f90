!> What the table of a scene file is made of: groups and the names within them.
module scene_parameter_types
   use scene_intervals, only: interval_t
   implicit none(type, external)
   private

   public :: group_t, parameter_t
   public :: text_length
   public :: kind_choice, kind_integer, kind_logical, kind_name, kind_real, kind_reals, kind_text
   public :: kind_wholes
   public :: need_always, need_choice, need_fluid, need_fracture, need_growth, need_never
   public :: need_tips
   public :: in_all, in_fluid, in_mechanics

   integer, parameter :: kind_real = 1
   integer, parameter :: kind_reals = 2  !< a list of any length
   integer, parameter :: kind_integer = 3
   integer, parameter :: kind_logical = 4
   integer, parameter :: kind_text = 5
   integer, parameter :: kind_name = 6  !< a text that is safe as a file name
   integer, parameter :: kind_choice = 7  !< a text out of `choices`
   integer, parameter :: kind_wholes = 8  !< a list of whole numbers, kept as reals

   integer, parameter :: need_never = 0
   integer, parameter :: need_always = 1  !< in every such group
   integer, parameter :: need_fluid = 2  !< where there is a fluid
   integer, parameter :: need_fracture = 3  !< where there is a fracture
   integer, parameter :: need_tips = 4  !< where growth or stress intensity factors are computed
   integer, parameter :: need_growth = 5  !< where fractures grow
   integer, parameter :: need_choice = 6  !< with the choice that it belongs to

   ! Scenes that may give a group or a parameter.
   integer, parameter :: in_all = 0
   integer, parameter :: in_fluid = 1  !< scenes with &fluid
   integer, parameter :: in_mechanics = 2  !< scenes without &fluid: mechanics only

   integer, parameter :: text_length = 256  !< longest text; names are shorter (scene_types)

   !> A namelist group.
   type :: group_t
      character(len=12) :: name = ""
      logical :: repeated = .false.  !< one group per item
      logical :: implied = .false.  !< an absent group stands for one that holds the defaults
      integer :: scenes = in_all  !< which may have it
      character(len=600) :: meaning = ""
   end type group_t

   !> A name within a group.
   type :: parameter_t
      character(len=12) :: group = ""
      character(len=20) :: name = ""
      integer :: kind = kind_real
      character(len=8) :: unit = "-"
      integer :: need = need_never
      character(len=16) :: default = ""  !< as a file would give it; empty: none
      character(len=40) :: absent = ""  !< what it means if neither given nor defaulted
      logical :: derived = .false.  !< then `absent` names the default, which follows from others
      type(interval_t) :: range = interval_t()
      integer :: scenes = in_all  !< which may give it
      !> Separated by `|`; of a single number: words that may stand in its place
      character(len=32) :: choices = ""
      character(len=160) :: meaning = ""
      ! Towards other names of its group:
      character(len=28) :: of = ""  !< the choice that it belongs to, as `law=slip`; empty: all
      character(len=20) :: with = ""  !< given only if this is given too
      character(len=20) :: at_most = ""  !< a number that it must not exceed
   end type parameter_t

end module scene_parameter_types

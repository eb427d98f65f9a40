!> What several tests of this room need: files by their lines, and scenes compared bit for bit.
module scene_test_files
   use base_kinds, only: lk, rk
   use scene_types, only: fracture_t, injection_t, probe_t, scene_t
   implicit none(type, external)
   private

   public :: delete_file, put_bytes, put_changed, put_lines, same_scene, source_path

   interface same
      module procedure same_real
      module procedure same_reals
   end interface same

contains

   !> A file of the source tree, which CTest gives in the environment.
   function source_path(name) result(path)
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: path
      character(len=4096) :: root

      call get_environment_variable("WINGCRACK_SOURCE", root)
      path = trim(root)//"/"//name
   end function source_path

   subroutine put_lines(path, lines)
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: lines(:)
      integer :: unit, i

      open (newunit=unit, file=path, action="write", status="replace")
      do i = 1, size(lines)
         write (unit, "(a)") trim(lines(i))
      end do
      close (unit)
   end subroutine put_lines

   !> The lines of a good scene, of which one or two are other ones.
   subroutine put_changed(path, good, line_1, text_1, line_2, text_2)
      character(len=*), intent(in) :: path, good(:)
      integer, intent(in) :: line_1, line_2
      character(len=*), intent(in) :: text_1, text_2
      character(len=len(good)) :: lines(size(good))

      lines = good
      lines(line_1) = text_1
      lines(line_2) = text_2
      call put_lines(path, lines)
   end subroutine put_changed

   subroutine put_bytes(path, bytes)
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: bytes
      integer :: unit

      open (newunit=unit, file=path, action="write", status="replace", access="stream", &
            form="unformatted")
      write (unit) bytes
      close (unit)
   end subroutine put_bytes

   subroutine delete_file(path)
      character(len=*), intent(in) :: path
      integer :: unit, status

      open (newunit=unit, file=path, iostat=status)
      if (status == 0) close (unit, status="delete")
   end subroutine delete_file

   !> Every component is the same, the numbers bit for bit.
   pure logical function same_scene(a, b)
      type(scene_t), intent(in) :: a, b
      integer :: i

      same_scene = .false.
      if (a%name /= b%name .or. a%title /= b%title) return
      if (.not. same([a%domain%x_min, a%domain%x_max, a%domain%y_min, a%domain%y_max], &
                     [b%domain%x_min, b%domain%x_max, b%domain%y_min, b%domain%y_max])) return
      if (a%domain%shape /= b%domain%shape) return
      if (.not. same([a%domain%x_centre, a%domain%y_centre, a%domain%radius], &
                     [b%domain%x_centre, b%domain%y_centre, b%domain%radius])) return
      if (.not. same([a%material%young, a%material%poisson, a%material%biot, a%material%porosity, &
                      a%material%permeability_xx, a%material%permeability_yy, &
                      a%material%permeability_xy, a%material%toughness], &
                     [b%material%young, b%material%poisson, b%material%biot, b%material%porosity, &
                      b%material%permeability_xx, b%material%permeability_yy, &
                      b%material%permeability_xy, b%material%toughness])) return
      if (a%material%plane_stress .neqv. b%material%plane_stress) return
      if (a%material%storage /= b%material%storage) return
      if (.not. same(a%fluid%compressibility, b%fluid%compressibility)) return
      if (.not. same(a%fluid%viscosity, b%fluid%viscosity)) return
      if (.not. same_regions(a, b)) return
      if (size(a%fractures) /= size(b%fractures)) return
      if (size(a%injections) /= size(b%injections)) return
      if (size(a%probes) /= size(b%probes)) return
      if (.not. all([(same_fracture(a%fractures(i), b%fractures(i)), i=1, &
                      size(a%fractures))])) return
      if (.not. all([(same_injection(a%injections(i), b%injections(i)), i=1, &
                      size(a%injections))])) return
      if (.not. all([(same_probe(a%probes(i), b%probes(i)), i=1, size(a%probes))])) return
      do i = 1, 4
         if (any(a%sides(i)%displacement_given .neqv. b%sides(i)%displacement_given)) return
         if (a%sides(i)%pressure_given .neqv. b%sides(i)%pressure_given) return
         if (.not. same([a%sides(i)%displacement, a%sides(i)%traction, a%sides(i)%pressure], &
                        [b%sides(i)%displacement, b%sides(i)%traction, b%sides(i)%pressure])) return
      end do
      if (a%initial%fracture_pressure /= b%initial%fracture_pressure) return
      if (.not. same(a%initial%pressure, b%initial%pressure)) return
      if (.not. same([a%time%end, a%time%step, a%time%share_after_growth, a%time%smallest_factor, &
                      a%time%tolerance], &
                     [b%time%end, b%time%step, b%time%share_after_growth, &
                      b%time%smallest_factor, b%time%tolerance])) return
      if (.not. same_loading(a, b)) return
      if (.not. same_levels(a, b)) return
      if (a%output%vtu .neqv. b%output%vtu) return
      if (.not. same([a%output%interval, a%output%stimulated_jump, a%output%out_of_plane_length], &
                     [b%output%interval, b%output%stimulated_jump, &
                      b%output%out_of_plane_length])) return
      same_scene = .true.
   end function same_scene

   pure logical function same_regions(a, b)
      type(scene_t), intent(in) :: a, b
      integer :: i

      same_regions = .false.
      if (allocated(a%regions) .neqv. allocated(b%regions)) return
      if (.not. allocated(a%regions)) then
         same_regions = .true.
         return
      end if
      if (size(a%regions) /= size(b%regions)) return
      do i = 1, size(a%regions)
         associate (p => a%regions(i), q => b%regions(i))
            if (p%name /= q%name .or. p%shape /= q%shape) return
          if (.not. (same(numbers(p%x), numbers(q%x)) .and. same(numbers(p%y), numbers(q%y)) .and. &
                       same(numbers(p%x_other), numbers(q%x_other)) .and. &
                       same(numbers(p%y_other), numbers(q%y_other)) .and. &
                       same(numbers(p%x_vertex), numbers(q%x_vertex)) .and. &
                       same(numbers(p%y_vertex), numbers(q%y_vertex)) .and. &
                       same(numbers(p%curvature), numbers(q%curvature)))) return
            if (.not. same([p%material%permeability_xx, p%material%permeability_yy, &
                            p%material%permeability_xy, p%material%young], &
                           [q%material%permeability_xx, q%material%permeability_yy, &
                            q%material%permeability_xy, q%material%young])) return
         end associate
      end do
      same_regions = .true.
   end function same_regions

   !> A list that may be none.
   pure function numbers(list)
      real(rk), allocatable, intent(in) :: list(:)
      real(rk), allocatable :: numbers(:)

      allocate (numbers(0))
      if (allocated(list)) numbers = list
   end function numbers

   !> Programme, restraints and point loads.
   pure logical function same_loading(a, b)
      type(scene_t), intent(in) :: a, b
      integer :: i

      same_loading = .false.
      if (a%adaptive%enabled .neqv. b%adaptive%enabled) return
      if (.not. same(a%adaptive%tolerance, b%adaptive%tolerance)) return
      if (a%adaptive%passes /= b%adaptive%passes) return
      if (a%discretization%element /= b%discretization%element) return
      if (.not. same([a%in_situ%stress, a%in_situ%per_y, a%in_situ%y_datum, a%gravity, &
                      a%material%density, a%fluid%density], &
                     [b%in_situ%stress, b%in_situ%per_y, b%in_situ%y_datum, b%gravity, &
                      b%material%density, b%fluid%density])) return
      if (.not. same_outline(a, b)) return
      if (.not. same([a%load%from, a%load%to], [b%load%from, b%load%to])) return
      if (a%load%steps /= b%load%steps) return
      if (allocated(a%load%factors) .neqv. allocated(b%load%factors)) return
      if (allocated(a%load%factors)) then
         if (size(a%load%factors) /= size(b%load%factors)) return
         if (.not. same(a%load%factors, b%load%factors)) return
      end if
      if (a%load%control /= b%load%control) return
      if (size(a%restraints) /= size(b%restraints)) return
      if (size(a%point_loads) /= size(b%point_loads)) return
      do i = 1, size(a%restraints)
         associate (p => a%restraints(i), q => b%restraints(i))
            if (any(p%displacement_given .neqv. q%displacement_given)) return
            if (.not. same([p%x, p%y, p%displacement], [q%x, q%y, q%displacement])) return
         end associate
      end do
      do i = 1, size(a%point_loads)
         associate (p => a%point_loads(i), q => b%point_loads(i))
            if (.not. same([p%x, p%y, p%force], [q%x, q%y, q%force])) return
         end associate
      end do
      same_loading = .true.
   end function same_loading

   !> Corners of a polygon, parts of the boundary of a polygon or disc, tractions along sides.
   pure logical function same_outline(a, b)
      type(scene_t), intent(in) :: a, b
      integer :: i

      same_outline = .false.
      if (allocated(a%domain%x) .neqv. allocated(b%domain%x)) return
      if (allocated(a%domain%x)) then
         if (.not. (same(a%domain%x, b%domain%x) .and. same(a%domain%y, b%domain%y))) return
      end if
      if (.not. same([a%sides%normal_traction, a%sides%shear_traction], &
                     [b%sides%normal_traction, b%sides%shear_traction])) return
      if (size(a%parts) /= size(b%parts)) return
      do i = 1, size(a%parts)
         associate (p => a%parts(i), q => b%parts(i))
            if (p%name /= q%name .or. (p%whole_rim .neqv. q%whole_rim)) return
            if (allocated(p%edges) .neqv. allocated(q%edges)) return
            if (allocated(p%edges)) then
               if (size(p%edges) /= size(q%edges)) return
               if (any(p%edges /= q%edges)) return
            end if
            if (any(p%displacement_given .neqv. q%displacement_given)) return
            if (.not. same([p%arc, p%displacement, p%traction, p%normal_traction, &
                            p%shear_traction], &
                           [q%arc, q%displacement, q%traction, q%normal_traction, &
                            q%shear_traction])) return
         end associate
      end do
      same_outline = .true.
   end function same_outline

   pure logical function same_levels(a, b)
      type(scene_t), intent(in) :: a, b

      same_levels = .false.
      associate (d => a%discretization, e => b%discretization)
         if (.not. same([d%size_fracture, d%size_boundary, d%window, d%fine_ratio, &
                         d%rosette_radius], &
                        [e%size_fracture, e%size_boundary, e%window, e%fine_ratio, &
                         e%rosette_radius])) return
         if (.not. same(d%newton_tolerance, e%newton_tolerance)) return
         if (d%rosette_sectors /= e%rosette_sectors .or. d%newton_max /= e%newton_max) return
         if (d%face_condition /= e%face_condition) return
         if (d%condensation /= e%condensation) return
         if (d%layers /= e%layers) return
         if (d%window_is_body .neqv. e%window_is_body) return
      end associate
      associate (g => a%growth, h => b%growth)
         if ((g%enabled .neqv. h%enabled) .or. (g%intensities .neqv. h%intensities)) return
         if (.not. same([g%increment, g%exponent, g%threshold, g%new_aperture, g%stop_gain], &
                        [h%increment, h%exponent, h%threshold, h%new_aperture, h%stop_gain])) return
         if (g%new_volume /= h%new_volume) return
      end associate
      same_levels = .true.
   end function same_levels

   pure logical function same_fracture(a, b)
      type(fracture_t), intent(in) :: a, b

      same_fracture = a%name == b%name .and. a%law == b%law
      same_fracture = same_fracture .and. same(a%x, b%x) .and. same(a%y, b%y)
      same_fracture = same_fracture .and. same([a%friction, a%dilation, a%aperture, a%slip, &
                                                a%slip_taper, a%face_pressure], &
                                               [b%friction, b%dilation, b%aperture, b%slip, &
                                                b%slip_taper, b%face_pressure])
      same_fracture = same_fracture .and. same([a%cell_size, a%window, a%increment], &
                                               [b%cell_size, b%window, b%increment])
      same_fracture = same_fracture .and. (a%held_closed .eqv. b%held_closed)
   end function same_fracture

   pure logical function same_injection(a, b)
      type(injection_t), intent(in) :: a, b

      same_injection = a%fracture == b%fracture .and. (a%at_point .eqv. b%at_point) .and. &
                       a%name == b%name .and. same_list(a%time, b%time) .and. &
                       same_list(a%rate, b%rate) .and. same_list(a%pressure, b%pressure) .and. &
                       same([a%x, a%y, a%start, a%end, a%storage, a%friction, a%turbulence], &
                            [b%x, b%y, b%start, b%end, b%storage, b%friction, b%turbulence])
      if (a%fracture == 0) same_injection = same_injection .and. same([a%radius], [b%radius])
      same_injection = same_injection .and. (allocated(a%entries) .eqv. allocated(b%entries)) &
                       .and. a%entry_count() == b%entry_count()
      if (.not. (same_injection .and. allocated(a%entries))) return
      same_injection = all(a%entries%fracture == b%entries%fracture) .and. &
                       same([a%entries%x, a%entries%y, a%entries%loss], &
                            [b%entries%x, b%entries%y, b%entries%loss])
   end function same_injection

   !> Both are absent, or alike.
   pure logical function same_list(a, b)
      real(rk), allocatable, intent(in) :: a(:), b(:)

      same_list = allocated(a) .eqv. allocated(b)
      if (.not. (same_list .and. allocated(a))) return
      same_list = size(a) == size(b)
      if (same_list) same_list = same(a, b)
   end function same_list

   pure logical function same_probe(a, b)
      type(probe_t), intent(in) :: a, b

      same_probe = a%name == b%name .and. same([a%x, a%y], [b%x, b%y])
   end function same_probe

   pure logical function same_real(a, b)
      real(rk), intent(in) :: a, b

      same_real = transfer(a, 0_lk) == transfer(b, 0_lk)
   end function same_real

   pure logical function same_reals(a, b)
      real(rk), intent(in) :: a(:), b(:)

      same_reals = size(a) == size(b)
      if (same_reals) same_reals = all(transfer(a, [0_lk]) == transfer(b, [0_lk]))
   end function same_reals

end module scene_test_files
